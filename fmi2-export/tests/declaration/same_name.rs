#[fmi2_export::interface]
mod variables {
    #[inputs]
    pub struct Input {
        /// Position
        pub position: f64,
    }

    #[outputs]
    pub struct Output {
        /// Position again
        pub position: f64,
    }
}

fn main() {}
