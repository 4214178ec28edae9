//! Buffer views and accessors: typed arrays within the buffers, strided, sparse and quantised ones included.

use super::buffers::Buffers;
use super::json::At;
use crate::error::Error;
use crate::memory;
use crate::precision::{self, Precision};

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    pub fn parse(at: &At<'_>) -> Result<Component, Error> {
        Ok(match at.uint()? {
            5120 => Component::I8,
            5121 => Component::U8,
            5122 => Component::I16,
            5123 => Component::U16,
            5125 => Component::U32,
            5126 => Component::F32,
            other => {
                return Err(at.error(format!("{other} is not a component type (5120 to 5123, 5125, 5126)")))
            }
        })
    }

    pub fn size(self) -> usize {
        match self {
            Component::I8 | Component::U8 => 1,
            Component::I16 | Component::U16 => 2,
            Component::U32 | Component::F32 => 4,
        }
    }

    /// The least and the greatest number that it stores.
    pub fn range(self) -> (f64, f64) {
        match self {
            Component::I8 => (-128.0, 127.0),
            Component::U8 => (0.0, 255.0),
            Component::I16 => (-32768.0, 32767.0),
            Component::U16 => (0.0, 65535.0),
            Component::U32 => (0.0, f64::from(u32::MAX)),
            Component::F32 => (f64::from(f32::MIN), f64::from(f32::MAX)),
        }
    }

    /// The stored number at the start of `bytes`.
    pub fn load(self, bytes: &[u8]) -> f64 {
        match self {
            Component::I8 => f64::from(bytes[0] as i8),
            Component::U8 => f64::from(bytes[0]),
            Component::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Component::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Component::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Component::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        }
    }

    /// Stores a number: rounded, and clamped to what the type holds.
    pub fn store(self, value: f64, bytes: &mut [u8]) {
        let whole = value.round();
        match self {
            Component::I8 => bytes[0] = whole as i8 as u8,
            Component::U8 => bytes[0] = whole as u8,
            Component::I16 => bytes[..2].copy_from_slice(&(whole as i16).to_le_bytes()),
            Component::U16 => bytes[..2].copy_from_slice(&(whole as u16).to_le_bytes()),
            Component::U32 => bytes[..4].copy_from_slice(&(whole as u32).to_le_bytes()),
            Component::F32 => bytes[..4].copy_from_slice(&(value as f32).to_le_bytes()),
        }
    }
}

/// A stretch of a buffer.
pub(super) struct View {
    pub buffer: usize,
    pub offset: usize,
    pub length: usize,
    pub stride: Option<usize>,
}

pub(super) fn read_views(root: &At<'_>, buffers: &Buffers) -> Result<Vec<View>, Error> {
    let read = |at: &At<'_>| {
        let buffer = at.need("buffer")?.index(buffers.buffers.len(), "buffers")?;
        let (offset, length) = (at.uint_or("byteOffset", 0)?, at.need("byteLength")?.uint()?);
        let within = buffers.buffers[buffer].length;
        if offset.checked_add(length).is_none_or(|end| end > within) {
            return Err(at.error(format!(
                "{length} bytes from byte {offset} on go beyond the {within} bytes of buffers[{buffer}]"
            )));
        }
        let stride = at.get("byteStride")?.map(|s| s.uint()).transpose()?.filter(|&s| s > 0);
        Ok(View { buffer, offset, length, stride })
    };
    root.items("bufferViews")?.iter().map(read).collect()
}

/// Elements that replace those of an accessor: `count` indices in one place, values in another.
pub(super) struct Sparse {
    count: usize,
    component: Component,
    /// The view and the offset in it.
    indices: (usize, usize),
    values: (usize, usize),
}

/// An array of vectors, matrices or numbers.
pub(super) struct Accessor {
    pub view: Option<usize>,
    offset: usize,
    pub component: Component,
    pub normalized: bool,
    pub count: usize,
    /// Numbers an element.
    pub width: usize,
    /// Bytes an element, the padding inside of small matrices included.
    pub size: usize,
    pub sparse: Option<Sparse>,
}

/// Bytes that something in the file reads: elements of `size` bytes, `stride` apart.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    pub storage: usize,
    pub start: usize,
    pub stride: usize,
    pub size: usize,
    pub count: usize,
}

impl Reach {
    pub fn end(&self) -> usize {
        self.start + self.stride * (self.count - 1) + self.size
    }

    /// Whether some byte may be in both, certain where the strides agree.
    pub fn meets(&self, other: &Reach) -> bool {
        if self.storage != other.storage || self.end() <= other.start || other.end() <= self.start {
            return false;
        }
        let apart = (other.start as i128 - self.start as i128).rem_euclid(self.stride as i128) as usize;
        self.stride != other.stride || apart < self.size || apart + other.size > self.stride
    }
}

/// Reads all accessors; each is checked to lie within its view. `room` limits those that have no bytes behind them.
pub(super) fn read_accessors(root: &At<'_>, views: &[View], room: usize) -> Result<Vec<Accessor>, Error> {
    root.items("accessors")?.iter().map(|at| read_accessor(at, views, room)).collect()
}

fn read_accessor(at: &At<'_>, views: &[View], room: usize) -> Result<Accessor, Error> {
    let view = at.index_of("bufferView", views.len(), "bufferViews")?;
    let component = Component::parse(&at.need("componentType")?)?;
    let kind = at.need("type")?;
    let (width, columns) = match kind.string()? {
        "SCALAR" => (1, 1),
        "VEC2" => (2, 1),
        "VEC3" => (3, 1),
        "VEC4" => (4, 1),
        "MAT2" => (4, 2),
        "MAT3" => (9, 3),
        "MAT4" => (16, 4),
        other => return Err(kind.error(format!("{other:?} is not a type of glTF"))),
    };
    // The columns of matrices start at multiples of four bytes.
    let size = match columns {
        1 => width * component.size(),
        _ => columns * (width / columns * component.size()).next_multiple_of(4),
    };
    let count = at.need("count")?;
    let accessor = Accessor {
        view,
        offset: at.uint_or("byteOffset", 0)?,
        component,
        normalized: at.bool_or("normalized", false)?,
        count: count.uint()?,
        width,
        size,
        sparse: at.get("sparse")?.map(|sparse| read_sparse(&sparse, views, size)).transpose()?,
    };
    if accessor.count == 0 {
        return Err(count.error("0 elements, glTF demands at least 1"));
    }
    let stride = accessor.stride(views);
    if stride < size {
        return Err(at.error(format!("elements of {size} bytes do not fit a byteStride of {stride}")));
    }
    match view {
        None if accessor.count > room => Err(count.error(format!(
            "{} elements without a bufferView are more than a file of this size may claim",
            accessor.count
        ))),
        Some(v) if !fits(accessor.offset, stride, size, accessor.count, views[v].length) => {
            Err(at.error(format!(
            "{} elements of {size} bytes, {stride} bytes apart, from byte {} on go beyond the {} bytes of \
             bufferViews[{v}]",
            accessor.count, accessor.offset, views[v].length
        )))
        }
        _ => Ok(accessor),
    }
}

fn read_sparse(at: &At<'_>, views: &[View], size: usize) -> Result<Sparse, Error> {
    let count = at.need("count")?.uint()?;
    let place = |at: &At<'_>, size: usize| {
        let view = at.need("bufferView")?.index(views.len(), "bufferViews")?;
        let offset = at.uint_or("byteOffset", 0)?;
        if count > 0 && !fits(offset, size, size, count, views[view].length) {
            return Err(at.error(format!(
                "{count} elements of {size} bytes go beyond the {} bytes of bufferViews[{view}]",
                views[view].length
            )));
        }
        Ok((view, offset))
    };
    let indices = at.need("indices")?;
    let component = Component::parse(&indices.need("componentType")?)?;
    if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
        return Err(indices.error("indices are unsigned whole numbers"));
    }
    let values = place(&at.need("values")?, size)?;
    Ok(Sparse { count, component, indices: place(&indices, component.size())?, values })
}

fn fits(offset: usize, stride: usize, size: usize, count: usize, length: usize) -> bool {
    let end = stride.checked_mul(count - 1).and_then(|n| n.checked_add(size)?.checked_add(offset));
    end.is_some_and(|end| end <= length)
}

impl Accessor {
    fn stride(&self, views: &[View]) -> usize {
        self.view.and_then(|v| views[v].stride).unwrap_or(self.size)
    }

    /// Where its elements are (without the sparse ones), if it has a view.
    pub fn reach(&self, views: &[View], buffers: &Buffers) -> Option<Reach> {
        let view = &views[self.view?];
        Some(Reach {
            storage: buffers.buffers[view.buffer].storage,
            start: view.offset + self.offset,
            stride: self.stride(views),
            size: self.size,
            count: self.count,
        })
    }

    /// What its sparse part reads.
    pub fn sparse_reach(&self, views: &[View], buffers: &Buffers) -> Vec<Reach> {
        let Some(sparse) = self.sparse.as_ref().filter(|s| s.count > 0) else { return Vec::new() };
        [(sparse.indices, sparse.component.size()), (sparse.values, self.size)]
            .map(|((view, offset), size)| Reach {
                storage: buffers.buffers[views[view].buffer].storage,
                start: views[view].offset + offset,
                stride: size,
                size,
                count: sparse.count,
            })
            .to_vec()
    }

    /// The buffer that holds (some of) its bytes.
    pub fn buffer(&self, views: &[View]) -> Option<usize> {
        Some(views[self.view.or(self.sparse.as_ref().map(|s| s.values.0))?].buffer)
    }

    /// Its elements one after another, the sparse ones put in; `index` is its own, for errors.
    pub fn packed(&self, index: usize, views: &[View], buffers: &Buffers) -> Result<Vec<u8>, Error> {
        let size = self.size;
        let bytes = |reach: &Reach| &buffers.storages[reach.storage].bytes[reach.start..reach.end()];
        let mut packed = memory::with_room(size * self.count)?;
        match self.reach(views, buffers) {
            None => packed.resize(size * self.count, 0),
            Some(reach) if reach.stride == size => packed.extend_from_slice(bytes(&reach)),
            Some(reach) => {
                bytes(&reach).chunks(reach.stride).for_each(|c| packed.extend_from_slice(&c[..size]));
            }
        }
        if let (Some(sparse), [indices, values]) = (&self.sparse, &self.sparse_reach(views, buffers)[..]) {
            let places = bytes(indices).chunks_exact(sparse.component.size());
            for (place, value) in places.zip(bytes(values).chunks_exact(size)) {
                let place = sparse.component.load(place) as usize;
                if place >= self.count {
                    return Err(Error::malformed(format!(
                        "accessors[{index}].sparse.indices: {place} is not among the {} elements",
                        self.count
                    )));
                }
                packed[size * place..][..size].copy_from_slice(value);
            }
        }
        Ok(packed)
    }

    /// What a stored number stands for: itself, or a fraction of the type's range.
    pub fn meaning(&self, stored: f64) -> f64 {
        match self.component {
            Component::F32 => stored,
            _ if self.normalized => (stored / self.component.range().1).max(-1.0),
            _ => stored,
        }
    }

    /// The number to store for a value, not rounded.
    pub fn stored(&self, value: f64) -> f64 {
        match self.component {
            Component::F32 => value,
            _ if self.normalized => value * self.component.range().1,
            _ => value,
        }
    }

    /// A value as it is once it is stored: rounded, and clamped to what the type holds.
    pub fn rounded(&self, value: f64) -> f64 {
        let (least, most) = self.component.range();
        match self.component {
            Component::F32 => precision::single(value),
            _ => self.meaning(self.stored(value).round().clamp(least, most)),
        }
    }

    /// The distance from a value to the next that can be stored.
    pub fn step(&self, value: f64) -> f64 {
        match self.component {
            Component::F32 => Precision::Single.step(value),
            _ if self.normalized => 1.0 / self.component.range().1,
            _ => 1.0,
        }
    }

    /// The first three numbers of element `i` of `packed`.
    pub fn vec3(&self, packed: &[u8], i: usize) -> [f64; 3] {
        std::array::from_fn(|k| self.number(packed, i, k))
    }

    /// Number `k` of element `i` of `packed`. Not for matrices of small numbers, whose columns are padded.
    pub fn number(&self, packed: &[u8], i: usize, k: usize) -> f64 {
        self.meaning(self.component.load(&packed[i * self.size + k * self.component.size()..]))
    }
}
