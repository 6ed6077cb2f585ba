//! Documents of the project whose figures take an emulator or other people's solvers.

use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

use super::html::Html;

/// Title, file, text.
const DOCUMENTS: [(&str, &str, &str); 3] = [
    ("Hardware in the loop on a host", "docs/hil-host.md", include_str!("../../../docs/hil-host.md")),
    ("Budgets", "docs/budgets.md", include_str!("../../../docs/budgets.md")),
    ("Validation", "docs/validation.md", include_str!("../../../docs/validation.md")),
];

/// Writes a section for each.
pub(super) fn write(page: &mut Html) {
    for (title, file, text) in DOCUMENTS {
        page.section(title);
        page.paragraph(&format!("As it stands in {file}; each table there names its command."));
        page.raw(&render(text));
    }
}

/// A document as HTML: without links, which lead nowhere from here, and its headings below the section's.
fn render(text: &str) -> String {
    let lower = |level| if level <= HeadingLevel::H2 { HeadingLevel::H3 } else { HeadingLevel::H4 };
    let events = Parser::new_ext(text, Options::ENABLE_TABLES).filter_map(|event| match event {
        Event::Start(Tag::Link { .. } | Tag::Image { .. }) | Event::End(TagEnd::Link | TagEnd::Image) => None,
        Event::Html(text) | Event::InlineHtml(text) => Some(Event::Text(text)),
        Event::Start(Tag::Heading { level, .. }) => Some(Event::Start(Tag::Heading {
            level: lower(level),
            id: None,
            classes: Vec::new(),
            attrs: Vec::new(),
        })),
        Event::End(TagEnd::Heading(level)) => Some(Event::End(TagEnd::Heading(lower(level)))),
        other => Some(other),
    });
    let mut out = String::new();
    html::push_html(&mut out, events);
    out
}

#[cfg(test)]
mod tests {
    use super::render;

    #[test]
    fn tables_stay_and_links_and_foreign_markup_do_not() {
        let html = render(
            "# A\n\n[text](https://example.org) <script>x</script>\n\n| a | b |\n|---|--:|\n| 1 | 2 |\n",
        );
        assert!(html.contains("<h3>A</h3>") && html.contains("<td") && html.contains("text"), "{html}");
        assert!(!html.contains("href") && !html.contains("<script"), "{html}");
    }
}
