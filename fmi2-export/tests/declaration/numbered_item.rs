#[fmi2_export::interface]
mod variables {
    /// What it does
    pub enum State {
        /// Nothing
        Idle = 4,
    }

    #[outputs]
    pub struct Output {
        /// What it does
        pub state: State,
    }
}

fn main() {}
