#[fmi2_export::interface]
mod variables {
    #[inputs]
    pub struct Input {
        /// Speed
        #[var(name = "spindle speed")]
        pub spindle_speed: f64,
    }
}

fn main() {}
