//! Notes the commit that the program is built from, for its records.

use std::process::Command;

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn main() {
    let hash = git(&["rev-parse", "--short=12", "HEAD"]).filter(|hash| !hash.is_empty());
    let changed = git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|s| !s.is_empty());
    let commit = hash.map_or("unknown".into(), |hash| if changed { hash + "+" } else { hash });
    println!("cargo::rustc-env=HARNESS_COMMIT={commit}");
    // Again whenever HEAD moves or any of the workspace's sources changes.
    if let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) {
        println!("cargo::rerun-if-changed={log}");
    }
    for source in
        ["src", "../common/src", "../common/shaders", "../billeter-plv/src", "../billeter-plv/shaders"]
    {
        println!("cargo::rerun-if-changed={source}");
    }
}
