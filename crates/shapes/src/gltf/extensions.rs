//! Which extensions can be carried over, and which change what the positions mean.

use super::json::At;
use crate::error::Error;

/// Extensions that say where vertices are in a way that this crate does not read, whether required or not.
const REFUSED: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

/// Splats as points with further attributes, which are carried over.
pub(super) const SPLATS: &str = "KHR_gaussian_splatting";

/// Extensions of that one which pack the splats: all whose names start so.
const PACKED_SPLATS: &str = "KHR_gaussian_splatting_compression";

/// Extensions that do not touch geometry: these, and all whose names start so.
const HARMLESS: [&str; 18] = [
    SPLATS,
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_techniques_webgl",
    "KHR_technique_webgl",
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "KHR_node_selectability",
    "KHR_node_hoverability",
    "EXT_texture_",
    "EXT_materials_",
    "EXT_lights_",
    "MSFT_texture_dds",
    "ADOBE_materials_",
    "FB_ngon_encoding",
];

/// Refuses a file that depends on an extension which this crate does not read.
pub(super) fn check(root: &At<'_>) -> Result<(), Error> {
    for at in root.items("extensionsRequired")? {
        let name = at.string()?;
        refuse_geometry(name)?;
        if !HARMLESS.iter().any(|start| name.starts_with(start)) {
            return Err(Error::unsupported(format!(
                "the file requires the extension {name}, which is not read"
            )));
        }
    }
    let mut places = root.items("nodes")?;
    places.extend(root.items("bufferViews")?);
    for mesh in root.items("meshes")? {
        places.extend(mesh.items("primitives")?);
    }
    for place in places {
        if let Some(extensions) = place.get("extensions")? {
            extensions.object()?.keys().try_for_each(|name| refuse_geometry(name))?;
            let Some(splats) = extensions.get(SPLATS)? else { continue };
            if let Some(extensions) = splats.get("extensions")? {
                extensions.object()?.keys().try_for_each(|name| refuse_geometry(name))?;
            }
        }
    }
    Ok(())
}

fn refuse_geometry(name: &str) -> Result<(), Error> {
    if REFUSED.contains(&name) || name.starts_with(PACKED_SPLATS) {
        return Err(Error::unsupported(format!(
            "the file uses the extension {name}, which is not read; export it without"
        )));
    }
    Ok(())
}
