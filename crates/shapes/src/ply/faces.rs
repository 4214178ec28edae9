//! Polygons and strips as triangles.

use super::header::{Header, Kind};
use crate::error::Error;
use crate::facts::FaceSizes;
use crate::memory;

/// The triangles found so far, and where the header says that there are more.
pub(super) struct Faces {
    pub triangles: Vec<[u32; 3]>,
    pub sizes: FaceSizes,
    /// How many strips.
    pub strips: usize,
    /// The element and the property of the polygons' corners.
    polygons_in: Option<(usize, usize)>,
    strips_in: Option<(usize, usize)>,
    vertices: usize,
}

/// What an element's list holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corners {
    Polygons,
    Strips,
}

impl Faces {
    pub(super) fn new(header: &Header, vertices: usize) -> Faces {
        let list = |name: &str| {
            let element = header.elements.iter().position(|e| e.name == name)?;
            let properties = &header.elements[element].properties;
            let property = properties.iter().position(|p| {
                matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
                    && matches!(p.kind, Kind::List { .. })
            })?;
            Some((element, property))
        };
        Faces {
            triangles: Vec::new(),
            sizes: FaceSizes::default(),
            strips: 0,
            polygons_in: list("face"),
            strips_in: list("tristrips"),
            vertices,
        }
    }

    /// What to take from the element, and from which of its properties.
    pub(super) fn wanted(&self, element: usize) -> Option<(Corners, usize)> {
        let of = |place: Option<(usize, usize)>| place.filter(|p| p.0 == element).map(|p| p.1);
        of(self.polygons_in)
            .map(|p| (Corners::Polygons, p))
            .or_else(|| of(self.strips_in).map(|p| (Corners::Strips, p)))
    }

    /// Adds row `row` of its element; `wrong` gives a sentence its place.
    pub(super) fn add(
        &mut self,
        what: Corners,
        row: usize,
        corners: &[f64],
        wrong: impl Fn(String) -> Error,
    ) -> Result<(), Error> {
        match what {
            Corners::Polygons => self.add_polygon(row, corners, wrong),
            Corners::Strips => self.add_strip(row, corners, wrong),
        }
    }

    fn index(&self, corner: f64) -> Option<u32> {
        (corner >= 0.0 && corner < self.vertices as f64 && corner.fract() == 0.0).then_some(corner as u32)
    }

    fn add_polygon(
        &mut self,
        row: usize,
        corners: &[f64],
        wrong: impl Fn(String) -> Error,
    ) -> Result<(), Error> {
        memory::reserve(&mut self.triangles, corners.len().saturating_sub(2))?;
        let mut fan = [0; 3];
        for (k, &corner) in corners.iter().enumerate() {
            fan[k.min(2)] = self.index(corner).ok_or_else(|| {
                let count = self.vertices;
                wrong(format!("face {row} has the vertex index {corner}, but there are {count} vertices"))
            })?;
            if k >= 2 {
                self.triangles.push(fan);
                fan[1] = fan[2];
            }
        }
        self.sizes.add(corners.len());
        Ok(())
    }

    /// Triangles that share an edge with the one before, every other one turned round; -1 starts anew.
    fn add_strip(
        &mut self,
        row: usize,
        corners: &[f64],
        wrong: impl Fn(String) -> Error,
    ) -> Result<(), Error> {
        memory::reserve(&mut self.triangles, corners.len().saturating_sub(2))?;
        self.strips += 1;
        let mut last = [0; 2];
        let mut length = 0;
        for &corner in corners {
            if corner == -1.0 {
                length = 0;
                continue;
            }
            let index = self.index(corner).ok_or_else(|| {
                let count = self.vertices;
                wrong(format!("strip {row} has the vertex index {corner}, but there are {count} vertices"))
            })?;
            if length >= 2 && last[0] != last[1] && last[0] != index && last[1] != index {
                let [a, b] = last;
                self.triangles.push(if length % 2 == 0 { [a, b, index] } else { [b, a, index] });
            }
            last = [last[1], index];
            length += 1;
        }
        Ok(())
    }
}
