//! What else is in the file, for a person to read.

use super::accessor::Component;
use super::extensions::SPLATS;
use super::json::At;
use super::Model;
use crate::document::Fact;
use crate::error::Error;
use crate::facts::SPLATS_MOVE;
use crate::text::printable;

pub(super) fn facts(root: &At<'_>, model: &Model) -> Result<Vec<Fact>, Error> {
    let mut facts: Vec<Fact> = Vec::new();
    let mut tell = |name: &str, what: String| {
        if !what.is_empty() {
            facts.push((name.to_string(), printable(what.as_bytes())));
        }
    };
    let count = |n: usize| if n == 0 { String::new() } else { n.to_string() };
    if let Some(generator) = root.need("asset")?.get("generator")? {
        tell("generator", generator.string()?.to_string());
    }
    tell("meshes", names(root, "meshes")?);
    tell("primitives", count(model.meshes.iter().map(Vec::len).sum()));
    tell("nodes", count(model.nodes.len()));
    tell("instances", count(model.instances.len()));
    let hidden = model.nodes.iter().filter(|n| n.mesh.is_some() && !n.shown).count();
    tell("meshes at nodes outside of every scene (stay)", count(hidden));
    tell("materials", names(root, "materials")?);
    tell("textures", count(root.items("textures")?.len()));
    tell("images", names(root, "images")?);
    tell("skins (deformed at rest)", count(model.skins.len()));

    let (mut targets, mut sets, mut colours, mut splats) = (0, 0, 0, false);
    for mesh in root.items("meshes")? {
        for primitive in mesh.items("primitives")? {
            let has = |name: &str| Ok(primitive.need("attributes")?.get(name)?.is_some());
            let run = |name: &str| -> Result<usize, Error> {
                let mut n = 0;
                while has(&format!("{name}_{n}"))? {
                    n += 1;
                }
                Ok(n)
            };
            if let Some(extensions) = primitive.get("extensions")? {
                splats |= extensions.get(SPLATS)?.is_some();
            }
            targets = targets.max(primitive.items("targets")?.len());
            sets = sets.max(run("TEXCOORD")?);
            colours = colours.max(run("COLOR")?);
        }
    }
    tell("morph targets (deltas kept)", count(targets));
    tell("animations (kept)", names(root, "animations")?);
    tell("UV sets", count(sets));
    tell("vertex colours", count(colours));
    tell("splats", if splats { SPLATS_MOVE.into() } else { String::new() });
    let quantised = model.blocks.iter().any(|b| model.accessors[b.accessor].component != Component::F32);
    tell("positions", if quantised { "quantised".into() } else { String::new() });
    let used = root.items("extensionsUsed")?;
    tell("extensions", used.iter().map(At::string).collect::<Result<Vec<_>, _>>()?.join(", "));
    Ok(facts)
}

/// How many things an array holds, and the names of the first of them.
fn names(root: &At<'_>, key: &str) -> Result<String, Error> {
    let items = root.items(key)?;
    let mut names = Vec::new();
    for item in &items {
        if let Some(name) = item.get("name")? {
            names.push(name.string()?);
        }
    }
    let more = if names.len() > 8 { ", ..." } else { "" };
    Ok(match (items.len(), names.len()) {
        (0, _) => String::new(),
        (n, 0) => n.to_string(),
        (n, k) => format!("{n} ({}{more})", names[..k.min(8)].join(", ")),
    })
}
