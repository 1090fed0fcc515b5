#[fmi2_export::interface]
mod variables {
    use fmi2_export::units::METRE;

    #[inputs]
    pub struct Input {
        /// Number of parts
        #[var(unit = METRE)]
        pub parts: i32,
        /// Switch
        #[var(range = 0.0..=1.0)]
        pub switch: bool,
        /// Length
        #[var(tunable)]
        pub length: f64,
    }

    #[outputs]
    pub struct Output {
        /// Force
        #[var(accepts_nan)]
        pub force: f64,
    }
}

fn main() {}
