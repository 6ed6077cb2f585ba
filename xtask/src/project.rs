//! Where things are: the workspace's root and cargo's output folder.

use crate::{Outcome, process};
use std::path::{Path, PathBuf};

/// The workspace's root folder.
pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the workspace")
}

/// Cargo's output folder. It is asked for, never spelled out: a user may have redirected it.
pub(crate) fn output_folder() -> Outcome<PathBuf> {
    let mut metadata =
        process::command("cargo", &["metadata", "--no-deps", "--offline", "--format-version", "1"]);
    let json = process::output(metadata.current_dir(root())).ok_or("`cargo metadata` failed")?;
    string_field(&json, "target_directory")
        .map(PathBuf::from)
        .ok_or_else(|| "`cargo metadata` names no target_directory".into())
}

/// The user's folder for things that outlive `cargo clean`.
pub(crate) fn cache_folder() -> Outcome<PathBuf> {
    let base = match (std::env::var_os("XDG_CACHE_HOME"), std::env::var_os("HOME")) {
        (Some(cache), _) if !cache.is_empty() => PathBuf::from(cache),
        (_, Some(home)) => PathBuf::from(home).join(".cache"),
        _ => return Err("neither XDG_CACHE_HOME nor HOME is set".into()),
    };
    Ok(base.join("eclss-rt"))
}

/// Value of the last `"name":"value"` in flat JSON, with JSON's escapes resolved as far as paths need them.
fn string_field(json: &str, name: &str) -> Option<String> {
    let start = json.rfind(&format!("\"{name}\":\""))? + name.len() + 4;
    let mut value = String::new();
    let mut characters = json[start..].chars();
    loop {
        match characters.next()? {
            '"' => return Some(value),
            '\\' => value.push(characters.next()?),
            other => value.push(other),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{root, string_field};

    /// A package's tests are modules of one program, so a file that no program names would never run.
    #[test]
    fn every_file_of_a_tests_folder_is_a_module() {
        let text = |path: &std::path::Path| std::fs::read_to_string(path).expect("it can be read");
        let packages = std::fs::read_dir(root()).expect("the workspace").flatten().map(|entry| entry.path());
        let folders: Vec<_> =
            packages.map(|package| package.join("tests")).filter(|path| path.is_dir()).collect();
        assert!(folders.len() > 4, "{folders:?}");
        for folder in folders {
            let manifest = text(&folder.with_file_name("Cargo.toml"));
            let files = std::fs::read_dir(&folder).expect("a folder").flatten().map(|entry| entry.path());
            let files: Vec<_> =
                files.filter(|path| path.extension().is_some_and(|end| end == "rs")).collect();
            let named = |path: &std::path::Path| {
                let stem = path.file_stem().expect("a file").to_string_lossy().into_owned();
                let target = format!("path = \"tests/{stem}.rs\"");
                let module = format!("mod {stem};");
                manifest.contains(&target)
                    || files.iter().any(|file| text(file).lines().any(|line| line == module))
            };
            for file in &files {
                assert!(
                    !manifest.contains("autotests = false") || named(file),
                    "{} runs never",
                    file.display()
                );
            }
        }
    }

    #[test]
    fn finds_a_string_and_resolves_escapes() {
        let json = r#"{"a":1,"target_directory":"C:\\x \"y\"","version":1}"#;
        assert_eq!(string_field(json, "target_directory").as_deref(), Some(r#"C:\x "y""#));
        assert_eq!(string_field(json, "absent"), None);
    }
}
