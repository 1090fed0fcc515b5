#[fmi2_export::interface]
mod variables {
    #[parameters]
    pub struct Parameters {
        /// Gain
        #[var(start = 2.0, paper = 1.0)]
        pub gain: f64,
    }
}

fn main() {}
