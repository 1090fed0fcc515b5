//! Blocks for signals: sources, filters, memory, arithmetic and limits.

mod coloured_noise;
mod harmonics;
mod integrator;
mod latch;
mod limit;
mod lookup;
mod low_pass;
mod peak;
mod product;
mod slew;
mod sum;

pub use coloured_noise::ColouredNoise;
pub use harmonics::Harmonics;
pub use integrator::Integrator;
pub use latch::Latch;
pub use limit::Limit;
pub use lookup::Lookup;
pub use low_pass::LowPass;
pub use peak::Peak;
pub use product::Product;
pub use slew::Slew;
pub use sum::Sum;
