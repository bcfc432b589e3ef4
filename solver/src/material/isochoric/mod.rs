//! Laws ψ = ψ̄(C̄) + U(J) \[Pa\] of the isochoric right Cauchy–Green tensor C̄ = J^(−2/3) C, one ψ̄
//! per file: rubbers and tissues that stiffen, with or without fibres.

mod demiray;
mod guccione;
mod holzapfel_gasser_ogden;
mod holzapfel_ogden;
mod law;
mod shape_energy;
mod yeoh;

pub use demiray::Demiray;
pub use guccione::Guccione;
pub use holzapfel_gasser_ogden::HolzapfelGasserOgden;
pub use holzapfel_ogden::HolzapfelOgden;
pub use law::Isochoric;
pub use shape_energy::{Constant, ShapeEnergy};
pub use yeoh::Yeoh;
