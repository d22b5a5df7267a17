//! Ways to order cells, by name.

use std::fmt;
use std::str::FromStr;

/// How cells are ordered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Method {
    /// By index: for pictures that do not depend on order.
    None,
    /// By the distance of centroids: fast, exact for no class of meshes.
    Centroid,
    /// By the eye's power with respect to the cells' circumspheres (Edelsbrunner 1990): exact for Delaunay meshes
    /// of convex domains, worse than centroids elsewhere.
    Power,
    /// Across interior faces (Williams 1992): exact for convex meshes.
    Mpvo,
    /// Across interior faces, searched from the boundary, far first (Williams 1992): a good preview of meshes that
    /// are not convex.
    Mpvonc,
    /// Across interior faces, and across gaps at the centres of the picture's pixels (Cook, Max, Silva and Williams
    /// 2004): exact along the rays of the picture for every mesh whose cells do not overlap.
    Exact,
    /// `mpvo` where the mesh is convex, else `exact`.
    #[default]
    Auto,
}

impl Method {
    /// Every method.
    pub const ALL: [Method; 7] =
        [Method::None, Method::Centroid, Method::Power, Method::Mpvo, Method::Mpvonc, Method::Exact, Method::Auto];

    /// The method's name.
    pub fn name(self) -> &'static str {
        match self {
            Method::None => "none",
            Method::Centroid => "centroid",
            Method::Power => "power",
            Method::Mpvo => "mpvo",
            Method::Mpvonc => "mpvonc",
            Method::Exact => "exact",
            Method::Auto => "auto",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that no method has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no ordering is named \"{0}\"; there are none, centroid, power, mpvo, mpvonc, exact, auto")]
pub struct UnknownMethod(pub String);

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Method, UnknownMethod> {
        Method::ALL.into_iter().find(|method| method.name() == name).ok_or_else(|| UnknownMethod(name.into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_is_read_back_from_its_name() {
        for method in Method::ALL {
            assert_eq!(method.to_string().parse(), Ok(method));
        }
        let error = "nearest".parse::<Method>().unwrap_err().to_string();
        assert!(error.contains("nearest"));
        assert!(Method::ALL.iter().all(|method| error.contains(method.name())), "{error}");
    }
}
