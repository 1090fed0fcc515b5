#[fmi2_export::interface]
mod variables {
    #[outputs]
    pub struct Output {
        /// Force
        #[var(essential)]
        pub force: f64,
    }

    #[parameters]
    pub struct Parameters {
        /// Gain
        #[var(essential, expert)]
        pub gain: f64,
        #[var(tunable)]
        pub filter: Filter,
    }
    /// Filter
    pub struct Filter {
        /// Bandwidth
        pub bandwidth: f64,
    }
}

fn main() {}
