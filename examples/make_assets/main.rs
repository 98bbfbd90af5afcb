//! Writes the meshes of the gallery into `assets/`.
//!
//! Run from the package's folder: `cargo run --release --no-default-features --example make_assets`.
//! The files are the same byte for byte wherever this runs: there is no randomness, coordinates are
//! rounded to fixed decimals, and elementary functions come from `libm`, never from the platform.
//! Lengths are decimetres (a teapot is about 3 wide), but for the landscape, which is in metres.

mod cloth;
mod dandelion;
mod hash;
mod knot;
mod lathe;
mod mesh;
mod shell;
mod solids;
mod tableware;
mod teapot;
mod terrain;

use std::path::Path;

use mesh::Mesh;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    std::fs::create_dir_all(&folder)?;
    let mut total = 0;
    for (name, about, mesh) in assets() {
        let text = mesh.to_obj(about);
        eprintln!("{name:14} {:6} faces {:5} kB", mesh.n_faces(), text.len() / 1024);
        total += text.len();
        std::fs::write(folder.join(format!("{name}.obj")), text)?;
    }
    eprintln!("{:14} {:18} kB", "all", total / 1024);
    Ok(())
}

/// File stem, first comment of the file, and the mesh.
fn assets() -> Vec<(&'static str, &'static str, Mesh)> {
    vec![
        ("backdrop", "A floor that bends up into a wall", cloth::backdrop()),
        ("block", "A block with bevelled edges, 1 high, about the origin", solids::block()),
        ("book-cover", "The boards and the round spine of a book", solids::book_cover()),
        ("book-pages", "The pages of that book", solids::book_pages()),
        ("bowl", "A turned bowl with two walls", tableware::bowl()),
        ("candle", "A candle with a hollow top", tableware::candle()),
        ("candlestick", "A turned candlestick", tableware::candlestick()),
        ("cube", "A cube of eight vertices, from -1 to 1", solids::cube()),
        ("curtain", "A hanging curtain, gathered in folds", cloth::curtain()),
        ("dandelion", "A dandelion clock: fine hairs on thin stalks", dandelion::dandelion()),
        ("egg", "An egg that stands on its blunt end", tableware::egg()),
        ("flame", "The flame of a candle", tableware::flame()),
        ("hills", "Hills around a lake whose water stands at y = 0", terrain::hills()),
        ("knot", "A trefoil knot plaited of three strands", knot::plaited_knot()),
        ("peaks", "A range of mountains behind those hills", terrain::peaks()),
        ("pawn", "A pawn of a chess set", tableware::pawn()),
        ("plate", "A plate with a foot", tableware::plate()),
        ("pyramid", "A pyramid of five vertices on a square of side 2", solids::pyramid()),
        ("ring", "A profiled ring of inner radius 1 about z", tableware::ring()),
        ("shell", "A wentletrap: a coiled shell with thin ribs, on its side", shell::wentletrap()),
        ("teapot", "M. Newell's teapot of 32 Bezier patches, 1975", teapot::teapot()),
        ("urn", "An urn with a lid", tableware::urn()),
        ("window", "A window frame with six panes", solids::window()),
    ]
}
