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
        /// Sample period
        #[var(expert)]
        pub sample_period: f64,
        #[var(expert)]
        pub observer: Observer,
    }
    /// Observer
    pub struct Observer {
        /// Pole
        #[var(essential)]
        pub pole: f64,
    }
    /// Filter
    pub struct Filter {
        /// Bandwidth
        pub bandwidth: f64,
    }
}

fn main() {}
