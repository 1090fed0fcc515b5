pub enum Reaction {
    Stop,
}

#[fmi2_export::interface]
mod variables {
    use super::Reaction;

    /// Fault
    #[reactions(Reaction, Stop = ["Stops and holds", "Rising edge of `reset`"])]
    pub enum Fault {
        /// No fault
        None,
        /// Position lost
        #[reaction(Stop)]
        #[hint("Check the encoder.")]
        Lost,
        /// Drive off
        #[reaction(Off)]
        #[detection("Current zero")]
        #[hint("Check the drive.")]
        Off,
    }

    #[outputs]
    pub struct Output {
        pub fault: Fault,
    }
}

fn main() {}
