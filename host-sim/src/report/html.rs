//! A page made of sections, tables and figures, complete in itself.

use std::fmt::Write as _;

use crate::schematic::escaped;

/// Colours and spaces; nothing is loaded.
const STYLE: &str = "
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif; margin: 0 auto;
  max-width: 1180px; padding: 16px; }
h1 { font-size: 26px; } h2 { margin-top: 44px; border-bottom: 1px solid #8888; } h3 { margin-top: 28px; }
table { border-collapse: collapse; margin: 10px 0; font-variant-numeric: tabular-nums; font-size: 14px; }
th, td { border-bottom: 1px solid #8886; padding: 3px 10px; text-align: left; vertical-align: top; }
td.number { text-align: right; }
.scroll { overflow-x: auto; }
figure { margin: 18px 0 30px; }
figure .picture { background: #ffffff; overflow-x: auto; border: 1px solid #8886; border-radius: 6px; padding: 6px; }
figure .picture svg { max-width: 100%; height: auto; display: block; margin: 0 auto; }
figcaption { margin-top: 6px; }
code { font-size: 13px; background: #8882; padding: 1px 5px; border-radius: 4px; }
pre { background: #8882; padding: 10px; overflow-x: auto; }
pre code { background: none; padding: 0; }
th.number { text-align: right; }
.command { color: #667; font-size: 13px; }
@media (prefers-color-scheme: dark) { .command { color: #99a; } }
";

/// A page that grows section by section.
#[derive(Debug)]
pub struct Html {
    title: String,
    body: String,
    sections: Vec<String>,
    figures: u32,
    tables: u32,
}

impl Html {
    /// An empty page.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), body: String::new(), sections: Vec::new(), figures: 0, tables: 0 }
    }

    fn push(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.body.write_fmt(text);
    }

    /// A place for the list of sections.
    pub(super) fn contents(&mut self) {
        self.push(format_args!("<!--contents-->"));
    }

    /// Begins a section.
    pub(super) fn section(&mut self, title: &str) {
        self.sections.push(title.to_owned());
        let number = self.sections.len();
        self.push(format_args!("<h2 id=\"s{number}\">{number}. {}</h2>\n", escaped(title)));
    }

    /// A paragraph of plain text.
    pub(super) fn paragraph(&mut self, text: &str) {
        self.push(format_args!("<p>{}</p>\n", escaped(text)));
    }

    /// HTML that was made by this program.
    pub(super) fn raw(&mut self, html: &str) {
        self.body.push_str(html);
    }

    /// A figure with what it shows and the command that makes it.
    pub(super) fn figure(&mut self, svg: &str, about: &str, command: &str) {
        self.figures += 1;
        let number = self.figures;
        // Inside a page an SVG has no XML head.
        let svg = svg.find("<svg").map_or("", |at| &svg[at..]);
        self.push(format_args!(
            "<figure id=\"f{number}\"><div class=\"picture\">{svg}</div><figcaption>Figure {number}. {} {}</figcaption>\
             </figure>\n",
            escaped(about),
            made_by(command)
        ));
    }

    /// A table with what it shows and the command that makes it. Cells that are numbers stand right.
    pub(super) fn table<const N: usize>(
        &mut self,
        head: [&str; N],
        rows: &[[String; N]],
        about: &str,
        command: &str,
    ) {
        self.tables += 1;
        let number = self.tables;
        self.push(format_args!("<div class=\"scroll\"><table id=\"t{number}\"><thead><tr>"));
        for (place, cell) in head.iter().enumerate() {
            // Over a column of numbers it stands right as they do.
            let over = rows.iter().any(|row| is_number(&row[place]));
            let class = if over { " class=\"number\"" } else { "" };
            self.push(format_args!("<th scope=\"col\"{class}>{}</th>", escaped(cell)));
        }
        self.push(format_args!("</tr></thead><tbody>\n"));
        for row in rows {
            self.push(format_args!("<tr>"));
            for cell in row {
                let class = if is_number(cell) { " class=\"number\"" } else { "" };
                self.push(format_args!("<td{class}>{}</td>", escaped(cell)));
            }
            self.push(format_args!("</tr>\n"));
        }
        self.push(format_args!(
            "</tbody></table></div><p>Table {number}. {} {}</p>\n",
            escaped(about),
            made_by(command)
        ));
    }

    /// The whole page.
    pub fn finish(self) -> String {
        let title = escaped(&self.title);
        let mut list = String::from("<nav aria-label=\"Contents\"><ol>");
        for (index, section) in self.sections.iter().enumerate() {
            let _ = write!(list, "<li><a href=\"#s{}\">{}</a></li>", index + 1, escaped(section));
        }
        list.push_str("</ol></nav>\n");
        let body = self.body.replacen("<!--contents-->", &list, 1);
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; \
             img-src data:\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n{body}</body>\n</html>\n"
        )
    }
}

/// Whether a cell begins as a number does.
fn is_number(cell: &str) -> bool {
    let plain = cell.trim_start_matches(['+', '−', '-', '≤', ' ']);
    plain.starts_with(|first: char| first.is_ascii_digit())
}

fn made_by(command: &str) -> String {
    format!("<span class=\"command\">Made by <code>{}</code></span>", escaped(command))
}

/// A number in scientific form with a real minus sign.
pub(super) fn scientific(number: f64, digits: usize) -> String {
    format!("{number:.digits$e}").replace('-', "−")
}

/// A number with `digits` behind the point and a real minus sign.
pub(super) fn fixed(number: f64, digits: usize) -> String {
    let text = format!("{number:.digits$}");
    // What rounds to nothing has no sign.
    let sign = if text.bytes().any(|byte| (b'1'..=b'9').contains(&byte)) { "−" } else { "" };
    text.replace('-', sign)
}
