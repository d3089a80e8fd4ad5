//! The page that needs no program, as one file: `cargo xtask page`.
//!
//! The script consists of the page's modules, each a function that returns what it exports. The file asks for nothing from
//! elsewhere, and its policy allows nothing but its own parts.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest as _, Sha256};

use crate::toolchain::{self, Toolchain, WEB};
use crate::{cross_target, firmware, read, workspace, write};

const PACKAGE: &str = "myointent-web";
const PROFILE: &str = "page";
/// Stack in bytes: room for the state of the largest accepted model.
const STACK: u32 = 16 << 20;

/// Arguments of the step.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// File to write.
    #[arg(long, default_value = "myointent.html")]
    pub out: PathBuf,
    /// Installs a missing compiler, as root, with apt-get.
    #[arg(long)]
    pub install: bool,
}

/// Writes the page.
pub fn run(arguments: &Arguments) -> Result<()> {
    let page = build(arguments.install)?;
    let out = &arguments.out;
    write(out, &page)?;
    println!("{}: {} KiB", out.display(), page.len() / 1024);
    Ok(())
}

/// Builds the page; returns its text.
pub fn build(install: bool) -> Result<String> {
    let toolchain = toolchain::find(WEB, install)?;
    let mut flags = firmware::short_paths();
    let _ = write!(flags, " -C link-arg=-zstack-size={STACK}");
    if matches!(toolchain, Toolchain::Debian { .. }) {
        flags += " -C linker-flavor=wasm-ld";
    }
    let mut cargo = toolchain.cargo("rustc", WEB);
    cargo
        .args(["--locked", "--package", PACKAGE, "--profile", PROFILE])
        .args(["--lib", "--crate-type", "cdylib"])
        .env("CARGO_TARGET_DIR", cross_target())
        .env("RUSTFLAGS", flags)
        .current_dir(workspace());
    crate::run(&mut cargo, "the page's module did not build")?;
    let module = cross_target().join(WEB).join(PROFILE).join("web.wasm");
    let module = read(&module)?;
    let folder = workspace().join("host/web/page");
    let part = |name: &str| -> Result<String> { Ok(String::from_utf8(read(&folder.join(name))?)?) };
    page(&part, &module)
}

fn packed(bytes: &[u8]) -> Result<String> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(bytes)?;
    Ok(STANDARD.encode(packed.finish()?))
}

/// Script that unpacks the page's script, whose hash the policy has, and runs it.
const LOADER: &str = r#"const packed = Uint8Array.from(atob(document.getElementById("script").textContent), (letter) => letter.charCodeAt(0));
const script = document.createElement("script");
script.type = "module";
script.textContent = await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
document.head.append(script);"#;

/// Reads a file of the page by its name.
type Read<'r> = &'r dyn Fn(&str) -> Result<String>;

/// Puts everything into `index.html`; script and module are compressed by gzip.
fn page(read: Read<'_>, module: &[u8]) -> Result<String> {
    let mut text = read("index.html")?;
    let mut styles = String::new();
    while let Some(name) = between(&text, "<link rel=\"stylesheet\" href=\"", "\">") {
        let link = format!("<link rel=\"stylesheet\" href=\"{name}\">\n");
        styles += &read(&name)?;
        text = text.replace(&link, "");
    }
    let script = between(&text, "<script type=\"module\" src=\"", "\"></script>");
    let script = script.context("index.html has no script")?;
    let icon = between(&text, "<link rel=\"icon\" href=\"", "\">").context("no icon")?;
    let worker = read("worker.js")?;
    let bundle = bundle(read, &script)?;
    for part in [&bundle, &worker, &styles] {
        ensure!(!part.contains("</"), "a script or style has `</` in it");
    }
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{}' 'sha256-{}' 'wasm-unsafe-eval'; style-src 'sha256-{}'; img-src data:; \
         worker-src blob:; base-uri 'none'; form-action 'none'",
        hash(LOADER),
        hash(&bundle),
        hash(&styles),
    );
    let icon_data = STANDARD.encode(read(&icon)?);
    let (bundle, module) = (packed(bundle.as_bytes())?, packed(module)?);
    let parts = [
        (
            "<meta charset=\"utf-8\">\n".to_owned(),
            format!(
                "<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n"
            ),
        ),
        (
            format!("<link rel=\"icon\" href=\"{icon}\">"),
            format!("<link rel=\"icon\" href=\"data:image/svg+xml;base64,{icon_data}\">"),
        ),
        (
            format!("<script type=\"module\" src=\"{script}\"></script>"),
            format!("<style>{styles}</style>\n<script type=\"module\">{LOADER}</script>"),
        ),
        (
            "</body>".to_owned(),
            format!(
                "<script type=\"text/plain\" id=\"worker\">{worker}</script>\n\
                 <script type=\"text/plain\" id=\"script\">{bundle}</script>\n\
                 <script type=\"text/plain\" id=\"program\">{module}</script>\n</body>"
            ),
        ),
    ];
    for (from, to) in parts {
        ensure!(text.matches(&from).count() == 1, "index.html: {from}");
        text = text.replace(&from, &to);
    }
    Ok(text)
}

/// The first text between two others.
fn between(text: &str, from: &str, to: &str) -> Option<String> {
    let (_, rest) = text.split_once(from)?;
    Some(rest.split_once(to)?.0.to_owned())
}

/// Hash of an inline part, as a policy has it.
fn hash(text: &str) -> String {
    STANDARD.encode(Sha256::digest(text))
}

/// One script of a module and all that it imports, in the order in which a browser runs them.
fn bundle(read: Read<'_>, name: &str) -> Result<String> {
    let mut script = String::new();
    add(read, name, &mut Vec::new(), &mut Vec::new(), &mut script)?;
    Ok(script)
}

fn add(
    read: Read<'_>,
    name: &str,
    importing: &mut Vec<String>,
    done: &mut Vec<String>,
    script: &mut String,
) -> Result<()> {
    if done.iter().any(|one| one == name) {
        return Ok(());
    }
    ensure!(
        !importing.iter().any(|one| one == name),
        "{name} imports itself by way of {importing:?}"
    );
    importing.push(name.to_owned());
    let mut body = String::new();
    let mut exported = Vec::new();
    for line in read(name)?.lines() {
        if let Some(import) = line.strip_prefix("import ") {
            let from = between(import, "\"./", "\";").with_context(|| format!("{name}: {line}"))?;
            add(read, &from, importing, done, script)?;
            if let Some(names) = between(import, "{", "}") {
                let _ = writeln!(body, "const {{{names}}} = {};", variable(&from));
            }
        } else if let Some(declared) = line.strip_prefix("export ") {
            let mut words = declared.split(|c: char| !c.is_alphanumeric() && c != '_');
            let (Some("class" | "const" | "function"), Some(own)) = (words.next(), words.next())
            else {
                bail!("{name}: {line}");
            };
            exported.push(own.to_owned());
            body += declared;
            body.push('\n');
        } else {
            body += line;
            body.push('\n');
        }
    }
    importing.pop();
    done.push(name.to_owned());
    let variable = variable(name);
    let exported = exported.join(", ");
    let _ = writeln!(
        script,
        "const {variable} = (() => {{\n{body}return {{ {exported} }};\n}})();"
    );
    Ok(())
}

fn variable(name: &str) -> String {
    let stem = Path::new(name).file_stem().unwrap_or_default();
    format!("module_{}", stem.to_string_lossy().replace('-', "_"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(name: &str) -> Result<String> {
        Ok(match name {
            "index.html" => {
                "<meta charset=\"utf-8\">\n<link rel=\"icon\" href=\"i.svg\">\n<link rel=\"stylesheet\" href=\"a.css\">\n\
                 <script type=\"module\" src=\"a.js\"></script>\n<body></body>"
            }
            "i.svg" => "<svg/>",
            "a.css" => "p { }",
            "worker.js" => "onmessage = null;",
            "a.js" => {
                "import { B, two } from \"./b-b.js\";\nimport \"./c.js\";\nimport { C } from \"./c.js\";\nB(C, two);\n"
            }
            "b-b.js" => {
                "import { C } from \"./c.js\";\nexport class B {}\nexport const two = C + 1;\n"
            }
            "c.js" => "export const C = 1;\n",
            "circle.js" => "import { a } from \"./circle.js\";\n",
            "default.js" => "export default 1;\n",
            _ => bail!("{name}"),
        }
        .to_owned())
    }

    #[test]
    fn modules_become_one_script_each_once_and_after_what_it_imports() {
        let expected = "const module_c = (() => {\nconst C = 1;\nreturn { C };\n})();\n\
            const module_b_b = (() => {\nconst { C } = module_c;\nclass B {}\nconst two = C + 1;\nreturn { B, two };\n})();\n\
            const module_a = (() => {\nconst { B, two } = module_b_b;\nconst { C } = module_c;\nB(C, two);\nreturn {  };\n})();\n";
        assert_eq!(bundle(&files, "a.js").unwrap(), expected);
        for refused in ["circle.js", "default.js", "missing.js"] {
            assert!(bundle(&files, refused).is_err(), "{refused}");
        }
    }

    #[test]
    fn the_page_has_all_parts_inside_and_a_policy_with_their_hashes() {
        let page = page(&files, &[0, 255]).unwrap();
        assert!(!page.contains("src=\""), "{page}");
        assert!(!page.contains("stylesheet"), "{page}");
        for part in ["script", "program"] {
            // The first bytes of gzip.
            let begun = format!("id=\"{part}\">H4sI");
            assert!(page.contains(&begun), "{page}");
        }
        // The digest of `p { }`, by sha256sum and base64.
        assert!(
            page.contains("style-src 'sha256-2H5CUCvyo5cSkj1YhUngR72ks13QrmBjgN+zz/lp2DY='"),
            "{page}"
        );
        assert!(page.contains("<style>p { }</style>"), "{page}");
    }
}
