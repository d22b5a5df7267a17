//! The scene file, checked as far as it can be without its mesh.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::DVec3;
use tetlux_image::{open_file, read_image};
use tetlux_mesh::{Component, Location, ScalarField, TetMesh};
use tetlux_optics::preset::read_preset;
use tetlux_optics::transfer::{ColorNode, OpacityNode, TransferFunction};
use tetlux_optics::widget::BivariateFunction;
use tetlux_optics::{Classification, Emphasis, ImageFunction, Light, NoData, Preset};

use crate::{Camera, Emphasized, Lighting, Method, Projection, Scene, SceneError, SurfaceSpec, document, even_opacity};

/// A scene without its mesh: plain values, which command-line flags may override.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneFile {
    /// What the picture shows.
    pub title: String,
    /// The mesh file, if the scene names one.
    pub mesh: Option<PathBuf>,
    /// Where no mesh file is named, the mesh is the program's own: a pair of vortices over a delta wing.
    pub built_in: bool,
    /// The PLOT3D solution that goes with it.
    pub solution: Option<PathBuf>,
    /// Tetrahedra a hexahedron becomes: 5 or 6.
    pub split: Option<u32>,
    /// The field that is classified; none: the mesh's only one.
    pub field: Option<String>,
    /// A component of a vector field, from 0; none: its magnitude.
    pub component: Option<usize>,
    /// The field of the opacity, where it is another; the second axis of widgets and images. None: there is no other,
    /// or it is the magnitude of the first field's gradient.
    pub second: Option<FieldSpec>,
    /// Luminance and opacity over the field, or both.
    pub transfer: TransferSource,
    /// Where the first and last node lie.
    pub range: NodeRange,
    /// Linear RGB of cells without data; none: the preset's, or ParaView's.
    pub nan_color: Option<[f64; 3]>,
    /// Their opacity; none: the preset's, or 0: they are left out.
    pub nan_opacity: Option<f64>,
    /// Light by the gradient of the field.
    pub light: Option<Light>,
    /// Opacity emphasised at the vertices by the field's derivatives.
    pub emphasis: Option<Emphasis>,
    /// Opaque surfaces in the volume.
    pub surfaces: Vec<SurfaceSpec>,
    /// World length over which an opacity of 1 is an optical depth of 1.
    pub unit_distance: UnitDistance,
    /// Cameras; none: one is framed automatically.
    pub cameras: Vec<CameraSpec>,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Linear RGB behind the volume.
    pub background: [f32; 3],
    /// The PNG shows the composited values as they are, as ParaView does, instead of encoding linear light.
    pub display_space: bool,
    /// How to render.
    pub method: Method,
    /// The scene in messages: its path.
    pub name: String,
}

/// Where a transfer function comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum TransferSource {
    /// The scene file itself.
    Nodes(TransferFunction),
    /// Colours of the scene file, and an opacity by how much of the mesh lies where: [`even_opacity`].
    Even {
        /// Luminance over the field; its opacity does not count.
        color: TransferFunction,
        /// The mean optical depth of the mesh where unit distance is its mean edge length, positive.
        depth: f64,
    },
    /// A ParaView preset file.
    Preset {
        /// The file: JSON or XML.
        path: PathBuf,
        /// Which of its presets; none: its only one.
        name: Option<String>,
    },
    /// Widgets over two fields.
    Widgets(BivariateFunction),
    /// A picture of a function of two fields: luminance and, as alpha, opacity; its top row lies at the upper end of the
    /// second field.
    Image {
        /// The file: EXR (values as they are, colour not premultiplied) or PNG (sRGB).
        path: PathBuf,
        /// What it spans along each axis; none: the fields' ranges.
        range: Option<[[f64; 2]; 2]>,
        /// The opacity of alpha 1.
        max_opacity: f64,
    },
}

/// A scalar by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FieldSpec {
    /// The field.
    pub name: String,
    /// A component of a vector field, from 0; none: its magnitude.
    pub component: Option<usize>,
}

/// Where the first and last node of a transfer function lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NodeRange {
    /// As the nodes say.
    AsGiven,
    /// Stretched to two scalars, ascending.
    Given([f64; 2]),
    /// Stretched to the field's range: the default of presets.
    Field,
}

/// World length over which an opacity of 1 is an optical depth of 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UnitDistance {
    /// The mesh's mean edge length: the default, as ParaView's.
    MeanEdge,
    /// A length in world units, positive.
    Length(f64),
    /// A share of the diagonal of the mesh's bounding box, positive.
    OfDiagonal(f64),
}

/// A camera, explicit as far as it is given, framed automatically for the rest.
#[derive(Debug, Clone, PartialEq)]
pub struct CameraSpec {
    /// World position of the eye.
    pub position: Option<DVec3>,
    /// World position in the middle of the picture; none: the mesh's centre.
    pub focal_point: Option<DVec3>,
    /// Direction of view of a camera without a position: it stands where it sees the whole mesh.
    pub direction: Option<DVec3>,
    /// A direction that is seen upright.
    pub view_up: DVec3,
    /// None: perspective, 30 degrees.
    pub projection: Option<Projection>,
    /// Depth before which nothing is seen.
    pub near: f64,
}

/// Bytes of a scene or preset file: far above all presets of ParaView in one.
const LONGEST_TEXT: u64 = 64 << 20;

/// Direction of view where the scene says nothing: three quarters from the front, from above.
const DEFAULT_DIRECTION: DVec3 = DVec3::new(-1.0, 1.5, -0.8);

impl SceneFile {
    /// Reads a scene file. Paths in it are relative to it.
    pub fn read(path: &Path) -> Result<SceneFile, SceneError> {
        let text = read_text(path)?;
        document::parse(path, &text)
    }

    /// Reads the text of a scene file; `path` is where it came from.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<SceneFile, SceneError> {
        document::parse(path.as_ref(), text)
    }

    /// The scene on a mesh, seen by its camera of that number.
    ///
    /// # Errors
    ///
    /// Whatever of the scene the mesh does not have. A scene with surfaces, which are files that other crates read: take
    /// [`SceneFile::surfaces`] out first, and add to [`Scene::surfaces`] what [`SurfaceSpec::on`] makes of each.
    pub fn scene(&self, mesh: &TetMesh, camera: usize) -> Result<Scene, SceneError> {
        let field = match (&self.field, mesh.fields()) {
            (Some(name), _) => name.clone(),
            (None, [only]) => only.name.clone(),
            (None, fields) => {
                let names: Vec<&str> = fields.iter().map(|f| f.name.as_str()).collect();
                return Err(self.missing(format!(
                    "the mesh has {} fields ({}): name one with name = \"...\" under [field]",
                    names.len(),
                    names.join(", ")
                )));
            }
        };
        if let Some(surface) = self.surfaces.first() {
            return Err(SceneError::Surface {
                path: surface.path.clone(),
                message:
                    "its triangles are not read yet: take the surfaces out of the scene file, and add each to the \
                          scene with SurfaceSpec::on"
                        .into(),
            });
        }
        let scalar = mesh.scalar(&field, component(self.component))?;
        let bivariate = matches!(self.transfer, TransferSource::Widgets(_) | TransferSource::Image { .. });
        // Neither gradients nor a second scalar where the scene does not ask for them.
        let gradients = self.light.is_some() || (bivariate && self.second.is_none());
        let gradients = gradients.then(|| mesh.vertex_gradients(&scalar));
        let second = match (&self.second, &gradients) {
            (Some(field), _) => Some(mesh.scalar(&field.name, component(field.component))?),
            (None, Some(gradients)) if bivariate => Some(gradient_magnitude(&scalar, gradients)),
            (None, _) => None,
        };
        // Of the default unit distance: another scales the depth, as it does any opacity.
        let even = |scalar: &ScalarField, depth| {
            even_opacity(mesh, scalar, with_width(scalar.range), depth, mesh.mean_edge_length())
        };
        let classification = self.classification(&scalar, second.as_ref(), &even)?;
        let emphasis = match (&self.emphasis, &classification) {
            (None, _) => None,
            (Some(emphasis), Classification::OneField(transfer)) => {
                Some(Emphasized::new(emphasis, transfer, mesh, &scalar)?)
            }
            (Some(_), _) => {
                return Err(self.missing(
                    "[emphasis] goes with a transfer function of one field: two fields, widgets and images have the \
                     gradient as their second axis instead"
                        .into(),
                ));
            }
        };
        Ok(Scene {
            classification,
            no_data: self.no_data()?,
            emphasis,
            lighting: self.light.zip(gradients).map(|(light, gradients)| Lighting::new(light, gradients)),
            unit_distance: match self.unit_distance {
                UnitDistance::MeanEdge => mesh.mean_edge_length(),
                UnitDistance::Length(length) => length,
                UnitDistance::OfDiagonal(share) => {
                    let [low, high] = mesh.local_bounds();
                    share * low.distance(high)
                }
            },
            surfaces: Vec::new(),
            camera: self.camera(mesh, camera)?,
            size: self.size,
            background: self.background,
            method: self.method,
            scalar,
            second,
        })
    }

    /// The classification of these fields; `even` makes an opacity of a mean depth.
    fn classification(
        &self,
        first: &ScalarField,
        second: Option<&ScalarField>,
        even: &dyn Fn(&ScalarField, f64) -> Vec<OpacityNode>,
    ) -> Result<Classification, SceneError> {
        let ranges = [first, second.unwrap_or(first)].map(|scalar| with_width(scalar.range));
        match (&self.transfer, second) {
            (TransferSource::Widgets(function), _) => {
                let fitted = || function.mapped(ranges.map(|r| r[0]), ranges.map(|r| r[1] - r[0]));
                let fit = self.range == NodeRange::Field;
                Ok(Classification::Widgets(if fit { fitted() } else { function.clone() }))
            }
            (TransferSource::Image { path, range, max_opacity }, _) => {
                image_function(path, range.unwrap_or(ranges), *max_opacity).map(Classification::Image)
            }
            (_, None) => Ok(Classification::OneField(self.transfer(first, even)?)),
            (_, Some(second)) => {
                let (color, opacity) = (self.transfer(first, even)?, self.transfer(second, even)?);
                let nodes = TransferFunction::new(color.color_nodes().to_vec(), opacity.opacity_nodes().to_vec());
                // Each list is one that a transfer function had already.
                Ok(Classification::TwoFields(nodes.unwrap_or(color)))
            }
        }
    }

    fn transfer(
        &self,
        scalar: &ScalarField,
        even: &dyn Fn(&ScalarField, f64) -> Vec<OpacityNode>,
    ) -> Result<TransferFunction, SceneError> {
        let range = match self.range {
            NodeRange::AsGiven => None,
            NodeRange::Given(range) => Some(range),
            NodeRange::Field => Some(with_width(scalar.range)),
        };
        match (&self.transfer, range) {
            (TransferSource::Nodes(nodes), None) => Ok(nodes.clone()),
            (TransferSource::Nodes(nodes), Some(range)) => Ok(stretched(nodes, range)),
            (TransferSource::Even { color, depth }, range) => {
                let color = range.map_or_else(|| color.clone(), |range| stretched(color, range));
                let nodes = TransferFunction::new(color.color_nodes().to_vec(), even(scalar, *depth));
                nodes.map_err(|error| self.missing(error.to_string()))
            }
            (TransferSource::Preset { path, name }, range) => {
                let failed = |source| SceneError::Preset { path: path.clone(), source };
                preset(path, name.as_deref())?.transfer_function(range).map_err(failed)
            }
            (TransferSource::Widgets(_) | TransferSource::Image { .. }, _) => {
                Err(self.missing("widgets and images are no transfer function of one field".into()))
            }
        }
    }

    /// What cells without data look like, by the scene or else by the preset.
    fn no_data(&self) -> Result<NoData, SceneError> {
        let (color, opacity) = match &self.transfer {
            TransferSource::Preset { path, name } => {
                let Preset { nan_color, nan_opacity, .. } = preset(path, name.as_deref())?;
                (nan_color, nan_opacity)
            }
            _ => (None, None),
        };
        let color = self.nan_color.or(color).unwrap_or(NoData::LUMINANCE);
        let opacity = self.nan_opacity.or(opacity).unwrap_or(0.0);
        // What the scene itself says has been checked: what is wrong is the preset's.
        let path = match &self.transfer {
            TransferSource::Preset { path, .. } => path.display().to_string(),
            _ => self.name.clone(),
        };
        NoData::new(color, opacity).map_err(|source| SceneError::NoData { path, source })
    }

    fn camera(&self, mesh: &TetMesh, number: usize) -> Result<Camera, SceneError> {
        let spec = match self.cameras.get(number) {
            Some(spec) => spec.clone(),
            None if number == 0 => CameraSpec {
                position: None,
                focal_point: None,
                direction: None,
                view_up: DVec3::Z,
                projection: None,
                near: 0.0,
            },
            None => {
                return Err(self.missing(format!(
                    "there is no camera {number}: the scene has {}, numbered from 0",
                    self.cameras.len()
                )));
            }
        };
        let framed = Camera::framing(mesh.bounds(), spec.direction.unwrap_or(DEFAULT_DIRECTION), spec.view_up);
        let camera = Camera {
            position: spec.position.unwrap_or(framed.position),
            focal_point: spec.focal_point.unwrap_or(framed.focal_point),
            view_up: spec.view_up,
            projection: spec.projection.unwrap_or(framed.projection),
            near: spec.near,
        };
        camera.view(self.size)?;
        Ok(camera)
    }

    fn missing(&self, message: String) -> SceneError {
        SceneError::Missing { path: self.name.clone(), message }
    }
}

fn preset(path: &Path, name: Option<&str>) -> Result<Preset, SceneError> {
    read_preset(&read_text(path)?, name).map_err(|source| SceneError::Preset { path: path.into(), source })
}

fn component(number: Option<usize>) -> Component {
    number.map_or(Component::Magnitude, Component::Index)
}

/// A constant field has no range to span: its value takes the lower end.
fn with_width([lowest, highest]: [f64; 2]) -> [f64; 2] {
    if lowest == highest { [lowest, lowest + lowest.abs().max(1.0)] } else { [lowest, highest] }
}

/// The magnitude of a scalar's gradient at every point, from the gradients there ([`TetMesh::vertex_gradients`]): linear
/// in each cell, as Song et al. 2009 have it.
pub fn gradient_magnitude(scalar: &ScalarField, gradients: &[DVec3]) -> ScalarField {
    let values: Vec<f64> = gradients.iter().map(|gradient| gradient.length()).collect();
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(0.0, f64::max));
    ScalarField {
        name: gradient_name(scalar),
        location: Location::Point,
        range: [low.min(high), high],
        missing: values.iter().filter(|value| !value.is_finite()).count(),
        values,
    }
}

/// The name of [`gradient_magnitude`]'s field.
pub(crate) fn gradient_name(scalar: &ScalarField) -> String {
    format!("gradient magnitude of {}", scalar.name)
}

fn image_function(path: &Path, range: [[f64; 2]; 2], max_opacity: f64) -> Result<ImageFunction, SceneError> {
    let image = read_image(path)?;
    let width = image.width() as usize;
    let rows = image.pixels().chunks(width).rev();
    let texels = rows.flatten().map(|&[r, g, b, a]| [r, g, b, (f64::from(a) * max_opacity) as f32]).collect();
    ImageFunction::new(width, texels, range).map_err(|source| SceneError::Image { path: path.into(), source })
}

/// A transfer function with its first and last control point moved to the ends of a range.
fn stretched(nodes: &TransferFunction, range: [f64; 2]) -> TransferFunction {
    let points = nodes.control_points();
    let (first, last) = (points[0], points[points.len() - 1]);
    // One control point: nothing to stretch.
    let scale = if last > first { (range[1] - range[0]) / (last - first) } else { 0.0 };
    let place = |s: f64| range[0] + (s - first) * scale;
    let color = nodes.color_nodes().iter().map(|n| ColorNode { s: place(n.s), ..*n }).collect();
    let opacity = nodes.opacity_nodes().iter().map(|n| OpacityNode { s: place(n.s), ..*n }).collect();
    // Monotone and finite, as the nodes are.
    TransferFunction::new(color, opacity).unwrap_or_else(|_| nodes.clone())
}

/// The text of a scene or preset, of [`LONGEST_TEXT`] at most.
fn read_text(path: &Path) -> Result<String, SceneError> {
    let read = || {
        let mut text = String::new();
        open_file(path)?.take(LONGEST_TEXT + 1).read_to_string(&mut text)?;
        if text.len() as u64 > LONGEST_TEXT {
            let message = format!("it is longer than {LONGEST_TEXT} bytes, and no scene or preset");
            return Err(std::io::Error::new(std::io::ErrorKind::FileTooLarge, message));
        }
        Ok(text)
    };
    read().map_err(|source| SceneError::Read { path: path.into(), source })
}
