//! Tables of ray-segment integrals: what published methods look up, what looks up better, and the error of each.
//!
//! A [`TableSpec`] is plain data; [`Table::build`] computes its texels from f64 integrals; [`measure`] states the error
//! of looking them up in f32; a [`Store`] keeps tables as OpenEXR files that are used only if their version, key, size
//! and texels are the expected ones. Tables of a transfer function live in a [`TableCache`].
//!
//! | table | axes | after |
//! |---|---|---|
//! | [`TableKind::Psi`] | x/(1+x) of both end depths | Moreland and Angel 2004 |
//! | [`TableKind::Q`] | optical depth, share of the front end | here; better by orders of magnitude |
//! | [`TableKind::FrontBack`], [`TableKind::QPair`] | both extinctions and the length; the same two as q | Song et al. 2009; here |
//! | [`TableKind::Gaussian`], [`TableKind::Sine`], [`TableKind::Triangle`] | strength and position | Song et al. 2009 |
//! | [`TableKind::GaussianBounded`], [`TableKind::SineBounded`] | the same, unbounded strength | here |
//! | [`TableKind::PreIntegrated`] | both scalars and the length | Röttger, Kraus and Ertl 2000; Kraus, Qiao and Ebert 2004 |
//! | [`TableKind::MeanExtinction`], [`TableKind::ColorRatio`] | both scalars; optical depth as third | here; exact opacity |
//!
//! Whole segments by the tables of Song et al., as they were published: [`published`].
//!
//! ```
//! use tetlux_tables::{Store, Table, TableSpec, measure, sample_weights};
//!
//! let table = Table::build(&TableSpec::default_q())?;
//! // The back end's weight in a segment of depths a = 2 (back) and b = 1 (front), within the measured error.
//! let [alpha, back, front] = sample_weights(&table, 2.0, 1.0);
//! let error = measure(&table)?;
//! assert!((f64::from(back) - tetlux_optics::segment::weights(2.0, 1.0).back).abs() <= error.max);
//! assert!(error.max < 5e-5);
//!
//! let folder = tempfile::tempdir()?;
//! let store = Store::new(folder.path());
//! store.write(&table, &error)?;
//! assert_eq!(store.read(table.spec())?.table, table);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod accuracy;
mod axis;
mod cache;
mod exr_file;
mod graded;
mod integral_tables;
mod lookup;
mod manifest;
mod measure;
mod picture;
mod precision;
mod preintegration;
pub mod published;
mod spec;
mod store;
mod table;
mod widget_tables;

pub use axis::{Axis, AxisMap, INFINITE};
pub use cache::TableCache;
pub use lookup::{
    sample_color_ratio, sample_front_back, sample_gaussian, sample_pre_integrated, sample_psi, sample_q, sample_sine,
    sample_triangle, sample_weights,
};
pub use manifest::{Entry, Manifest};
pub use measure::{measure, measure_color_ratio, measure_widget};
pub use picture::{PictureError, error_picture, value_picture};
pub use precision::Precision;
pub use spec::{Construction, Design, MAX_NODES, MAX_TEXELS, SpecError, TableKind, TableSpec, Thickness, TransferSpec};
pub use store::{GENERATOR_VERSION, Metadata, SCHEMA_VERSION, Store, StoreError, StoredTable, key, remedy};
pub use table::{MeasuredError, Table};
