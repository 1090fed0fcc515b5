#[fmi2_export::interface]
mod variables {
    use std::time::Duration;

    #[parameters]
    pub struct Parameters {
        /// Time of the approach
        pub time: Duration,
        /// What the law makes of it
        #[var(hidden)]
        pub made: Duration,
    }
}

fn main() {}
