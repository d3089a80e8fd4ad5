//! Files of the page, compiled into the program that serves it.

/// Makes path, MIME type and text of each file.
macro_rules! files {
    ($($path:literal $page:literal)*; $($kind:ident: $($name:literal)*;)*) => {
        &[
            $(($path, HTML, include_str!(concat!("../page/", $page))),)*
            $($(($name, $kind, include_str!(concat!("../page/", $name))),)*)*
        ]
    };
}

/// Path, MIME type and text of each file.
#[rustfmt::skip]
pub const FILES: &[(&str, &str, &str)] = files! {
    "" "index.html" "sessions" "sessions.html";
    ICON: "icon.svg";
    CSS: "live.css" "layout.css" "session.css" "wearer.css" "sessions.css";
    SCRIPT: "agreement.js" "arm.js" "armband.js" "arrival.js" "blocks.js" "bluetooth.js" "calibration.js" "clock.js" "dom.js" "empty.js"
            "ending.js" "english-session.js" "english.js" "german-program.js" "german-session.js" "german.js" "gestures.js"
            "guide.js" "help.js" "history.js" "link.js" "live.js" "notes.js" "now.js" "panel.js" "placement.js"
            "rates.js" "recordings.js" "result.js" "rows.js" "save.js" "serial.js" "session.js"
            "sessions.js" "socket.js" "sources.js" "steps.js" "store.js" "stored.js" "tab.js"
            "texts.js" "time.js" "traces.js" "wearer.js";
};

const HTML: &str = "text/html; charset=utf-8";
const ICON: &str = "image/svg+xml";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
