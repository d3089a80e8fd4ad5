//! Files of the page, compiled into the program that serves it.

/// Path, MIME type and text of each file.
pub const FILES: [(&str, &str, &str); 46] = [
    ("", HTML, include_str!("../page/index.html")),
    (
        "icon.svg",
        "image/svg+xml",
        include_str!("../page/icon.svg"),
    ),
    ("live.css", CSS, include_str!("../page/live.css")),
    ("layout.css", CSS, include_str!("../page/layout.css")),
    ("session.css", CSS, include_str!("../page/session.css")),
    ("wearer.css", CSS, include_str!("../page/wearer.css")),
    ("sessions", HTML, include_str!("../page/sessions.html")),
    ("sessions.css", CSS, include_str!("../page/sessions.css")),
    ("sessions.js", SCRIPT, include_str!("../page/sessions.js")),
    ("stored.js", SCRIPT, include_str!("../page/stored.js")),
    ("link.js", SCRIPT, include_str!("../page/link.js")),
    ("socket.js", SCRIPT, include_str!("../page/socket.js")),
    ("tab.js", SCRIPT, include_str!("../page/tab.js")),
    ("serial.js", SCRIPT, include_str!("../page/serial.js")),
    ("bluetooth.js", SCRIPT, include_str!("../page/bluetooth.js")),
    ("sources.js", SCRIPT, include_str!("../page/sources.js")),
    ("texts.js", SCRIPT, include_str!("../page/texts.js")),
    ("english.js", SCRIPT, include_str!("../page/english.js")),
    (
        "english-session.js",
        SCRIPT,
        include_str!("../page/english-session.js"),
    ),
    ("german.js", SCRIPT, include_str!("../page/german.js")),
    (
        "german-session.js",
        SCRIPT,
        include_str!("../page/german-session.js"),
    ),
    (
        "german-program.js",
        SCRIPT,
        include_str!("../page/german-program.js"),
    ),
    ("wearer.js", SCRIPT, include_str!("../page/wearer.js")),
    ("live.js", SCRIPT, include_str!("../page/live.js")),
    ("agreement.js", SCRIPT, include_str!("../page/agreement.js")),
    ("armband.js", SCRIPT, include_str!("../page/armband.js")),
    (
        "calibration.js",
        SCRIPT,
        include_str!("../page/calibration.js"),
    ),
    ("clock.js", SCRIPT, include_str!("../page/clock.js")),
    ("empty.js", SCRIPT, include_str!("../page/empty.js")),
    ("ending.js", SCRIPT, include_str!("../page/ending.js")),
    ("gestures.js", SCRIPT, include_str!("../page/gestures.js")),
    ("now.js", SCRIPT, include_str!("../page/now.js")),
    ("help.js", SCRIPT, include_str!("../page/help.js")),
    ("panel.js", SCRIPT, include_str!("../page/panel.js")),
    ("history.js", SCRIPT, include_str!("../page/history.js")),
    ("placement.js", SCRIPT, include_str!("../page/placement.js")),
    ("rates.js", SCRIPT, include_str!("../page/rates.js")),
    (
        "recordings.js",
        SCRIPT,
        include_str!("../page/recordings.js"),
    ),
    ("store.js", SCRIPT, include_str!("../page/store.js")),
    ("result.js", SCRIPT, include_str!("../page/result.js")),
    ("rows.js", SCRIPT, include_str!("../page/rows.js")),
    ("save.js", SCRIPT, include_str!("../page/save.js")),
    ("session.js", SCRIPT, include_str!("../page/session.js")),
    ("steps.js", SCRIPT, include_str!("../page/steps.js")),
    ("time.js", SCRIPT, include_str!("../page/time.js")),
    ("traces.js", SCRIPT, include_str!("../page/traces.js")),
];

const HTML: &str = "text/html; charset=utf-8";
/// MIME type of a style sheet.
pub const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
