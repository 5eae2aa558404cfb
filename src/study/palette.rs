//! Colors of charts and pages in light and dark mode. The hues are those of Okabe & Ito (2008),
//! which color-blind viewers can distinguish, with adjusted lightness for contrast with the
//! background.

/// Number of series before colors repeat.
pub const SERIES: usize = 8;

const LIGHT: [&str; SERIES] =
    ["#0072b2", "#c74e00", "#00805c", "#b04f8a", "#8a6d00", "#3b8ec4", "#444444", "#9a3b3b"];
const DARK: [&str; SERIES] =
    ["#56b4e9", "#ff8f4d", "#2fcf9f", "#e79ac9", "#e6c84a", "#9cc9ff", "#c8c8c8", "#ff9c9c"];

/// Style sheet with the color variables and the classes of charts.
pub fn style() -> String {
    let variables = |ink: &str, soft: &str, line: &str, ground: &str, series: [&str; SERIES]| {
        let series: String =
            (0..).zip(series).map(|(i, color)| format!("--s{i}:{color};")).collect();
        format!("--ink:{ink};--soft:{soft};--line:{line};--ground:{ground};{series}")
    };
    let light = variables("#1c1f23", "#5b636d", "#d9dde2", "#ffffff", LIGHT);
    let dark = variables("#e8eaed", "#a5adb8", "#3a4048", "#15181c", DARK);
    let classes: String = (0..SERIES).map(|i| format!(".s{i}{{color:var(--s{i})}}")).collect();
    format!(
        ":root{{{light}}}@media(prefers-color-scheme:dark){{:root{{{dark}}}}}{classes}\
         .chart text{{font:12px system-ui,sans-serif;fill:var(--ink)}}.chart .soft{{fill:var(--soft)}}\
         .chart .grid{{stroke:var(--line);fill:none}}.chart .frame{{stroke:var(--soft);fill:none}}\
         .chart .curve{{stroke:currentColor;fill:none;stroke-width:2;stroke-linejoin:round}}\
         .chart .dashed{{stroke-dasharray:6 4}}.chart .faint{{stroke:var(--line);fill:none;stroke-width:1.5}}\
         .chart .band{{fill:currentColor;opacity:.14}}.chart .mark{{fill:currentColor;stroke:var(--ground)}}\
         .chart .hollow{{fill:var(--ground);stroke:currentColor;stroke-width:1.5}}\
         .chart .name{{fill:currentColor}}.chart .leader{{stroke:currentColor;opacity:.5}}\
         .chart .guide{{stroke:var(--soft);stroke-dasharray:2 3;fill:none}}"
    )
}
