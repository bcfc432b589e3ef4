//! Names of other files in the text of a case.

use crate::scene::edit::values::replace;
use std::path::{Component, Path, PathBuf};
use toml_edit::visit_mut::{VisitMut, visit_table_like_kv_mut};
use toml_edit::{DocumentMut, Item, KeyMut, TomlError, Value};

/// Gives other files other names.
struct Renamed<F>(F);

impl<F: FnMut(&str) -> String> VisitMut for Renamed<F> {
    fn visit_table_like_kv_mut(&mut self, key: KeyMut<'_>, node: &mut Item) {
        if key.get() == "file"
            && let Some(value) = node.as_value_mut()
            && let Some(name) = value.as_str()
        {
            let name = (self.0)(name);
            replace(value, Value::from(name));
        }
        visit_table_like_kv_mut(self, key, node);
    }
}

/// The text of a case with absolute paths for the files that it names relative to
/// `base`, so that it can be stored in any folder.
pub fn with_absolute_paths(text: &str, base: &Path) -> Result<String, TomlError> {
    renamed(text, |name| plain(&base.join(name)).display().to_string())
}

/// The text of a case that is to be stored in `folder`, with paths from there for the files that
/// it names relative to `base`, so that both can be moved together; a path is absolute where they
/// have no more in common than the root of a file system.
pub fn with_paths_from(text: &str, base: &Path, folder: &Path) -> Result<String, TomlError> {
    let folder = plain(folder);
    renamed(text, |name| {
        let path = plain(&base.join(name));
        relative(&path, &folder).unwrap_or_else(|| path.display().to_string())
    })
}

fn renamed(text: &str, name: impl FnMut(&str) -> String) -> Result<String, TomlError> {
    let mut document: DocumentMut = text.parse()?;
    Renamed(name).visit_document_mut(&mut document);
    Ok(document.to_string())
}

/// The path without links, absolute if the file exists.
fn plain(path: &Path) -> PathBuf {
    let real = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    // Windows puts a mark before such paths that other programs do not read.
    let text = real.to_str().and_then(|text| text.strip_prefix(r"\\?\"));
    text.filter(|text| cfg!(windows) && !text.starts_with("UNC"))
        .map_or(real.clone(), PathBuf::from)
}

/// The way from a folder to a file, with slashes, which every system reads.
fn relative(path: &Path, folder: &Path) -> Option<String> {
    let (path, folder): (Vec<_>, Vec<_>) =
        (path.components().collect(), folder.components().collect());
    let common = path.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    path[..common].iter().find(|part| matches!(part, Component::Normal(_)))?;
    let up = folder[common..].iter().map(|_| "..".to_string());
    let down = path[common..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_that_moves_names_its_surface_from_its_new_folder() {
        let root = tempfile::tempdir().unwrap();
        let (base, out) = (root.path().join("mine"), root.path().join("reports/tune"));
        std::fs::create_dir_all(&base).unwrap();
        std::fs::create_dir_all(&out).unwrap();
        std::fs::write(base.join("ball.stl"), "").unwrap();
        let text = with_paths_from("shape.surface.file = \"ball.stl\"\n", &base, &out).unwrap();
        assert_eq!(text, "shape.surface.file = \"../../mine/ball.stl\"\n");
    }

    #[test]
    fn nothing_is_relative_to_a_folder_of_another_tree() {
        assert_eq!(relative(Path::new("/data/ball.stl"), Path::new("/home/reports")), None);
    }
}
