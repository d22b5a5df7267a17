//! What one ray segment through a flame-like transfer function emits and lets through.
#![expect(clippy::print_stdout, reason = "an example shows its result")]

use tetlux_optics::segment::{segment, weights};
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction, TransferFunctionError};

fn main() -> Result<(), TransferFunctionError> {
    let tf = TransferFunction::new(
        vec![ColorNode { s: 0.0, rgb: [0.9, 0.1, 0.0] }, ColorNode { s: 1.0, rgb: [1.0, 0.9, 0.5] }],
        vec![OpacityNode { s: 0.3, opacity: 0.0 }, OpacityNode { s: 1.0, opacity: 4.0 }],
    )?;
    let through = segment(&tf, 1.0, 0.2, 0.8, 1.5);
    println!("transmittance {:.6}, colour {:.6?}", through.transmittance, through.color);
    let parts = weights(2.0, 0.5);
    println!("weights for a = 2, b = 0.5: back {:.6}, front {:.6}", parts.back, parts.front);
    Ok(())
}
