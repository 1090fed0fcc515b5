#[fmi2_export::interface]
mod variables {
    use std::time::Duration;

    #[parameters]
    pub struct Parameters {
        /// Time of the approach
        pub time: Duration,
        /// Result of the model
        #[var(hidden)]
        pub made: Duration,
    }
}

fn main() {}
