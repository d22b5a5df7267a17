//! How to render: every axis by name.

use serde::{Deserialize, Serialize};

/// Declares an enum whose values are spelt in kebab-case in scene files and on the command line.
macro_rules! named {
    ($(#[$outer:meta])* $name:ident { $($(#[$inner:meta])* $value:ident),+ $(,)? }) => {
        $(#[$outer])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum $name { $($(#[$inner])* $value),+ }

        impl $name {
            /// Every value.
            pub const ALL: &'static [Self] = &[$(Self::$value),+];
        }

        impl std::fmt::Display for $name {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                self.serialize(f)
            }
        }

        impl std::str::FromStr for $name {
            type Err = UnknownName;
            fn from_str(name: &str) -> Result<Self, UnknownName> {
                parse_name(name)
            }
        }
    };
}

named! {
    /// What computes the picture.
    Backend {
        /// The plan chooses.
        #[default]
        Auto,
        /// wgpu.
        Gpu,
        /// The processor's cores.
        Cpu,
    }
}

named! {
    /// The order in which cells are composited.
    Order {
        /// The plan chooses.
        #[default]
        Auto,
        /// Any: exact where the picture does not depend on order.
        None,
        /// By the distance of the cells' centroids: fast, and wrong wherever centroids mislead.
        Centroid,
        /// Every pixel's segments sorted along its ray: exact on meshes whose cells do not overlap. CPU only.
        Pixel,
    }
}

named! {
    /// The integral along a ray inside a cell, between two control points of the transfer function.
    Integrator {
        /// Linear luminance and extinction, evaluated directly without a table: relative error 1e-5.
        #[default]
        Direct,
        /// Mean luminance and extinction: opacity exact, colour off by up to half the opacity.
        Average,
    }
}

/// A choice on every axis, and the error that is allowed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Method {
    /// What computes the picture.
    pub backend: Backend,
    /// The order of compositing.
    pub order: Order,
    /// The integral inside a cell.
    pub integrator: Integrator,
    /// Largest error of a pixel's colour or alpha, linear, that `compare` accepts.
    pub max_error: f64,
}

impl Default for Method {
    fn default() -> Self {
        // A quarter of an 8-bit step.
        Method { backend: Backend::Auto, order: Order::Auto, integrator: Integrator::Direct, max_error: 1e-3 }
    }
}

/// A name that none of the values of an axis has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct UnknownName(String);

/// The value of that name; the error lists the names there are.
pub fn parse_name<'de, T: Deserialize<'de>>(name: &'de str) -> Result<T, UnknownName> {
    use serde::de::{IntoDeserializer, value::Error};
    T::deserialize(IntoDeserializer::<Error>::into_deserializer(name)).map_err(|e| UnknownName(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_read_back_from_its_name() {
        for &order in Order::ALL {
            assert_eq!(order.to_string().parse(), Ok(order));
        }
        assert_eq!(Backend::Gpu.to_string(), "gpu");
        let error = "nearest".parse::<Integrator>().unwrap_err().to_string();
        assert!(error.contains("nearest") && error.contains("direct") && error.contains("average"), "{error}");
    }
}
