//! One page: the table, and below it every report with its pictures.

use jump_lab::papers::Row;

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:76rem;padding:0 1rem;color:#1f2328}\
table{border-collapse:collapse;width:100%}td,th{border-bottom:1px solid #d0d7de;padding:.35rem .5rem;text-align:left;vertical-align:top}\
.NO{color:#b42318;font-weight:600}.yes{color:#1a7f37}iframe{width:100%;height:46rem;border:1px solid #d0d7de;margin-bottom:1.5rem}\
small{color:#57606a}";

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}

/// The page; `reports` are folders beside it that hold a `report.html` each.
pub(crate) fn html(rows: &[Row], reports: &[String]) -> String {
    let row = |row: &Row| {
        format!(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"{mark}\">{mark}<br><small>{}</small></td></tr>\n",
            row.paper,
            escape(&row.item),
            escape(&row.theirs),
            escape(&row.ours),
            row.sim.map_or("", jump_lab::Sim::name),
            escape(&row.reason),
            mark = row.mark(),
        )
    };
    let report = |name: &String| {
        format!(
            "<h2>{name}</h2>\n<iframe loading=\"lazy\" title=\"{name}\" src=\"{name}/report.html\"></iframe>\n"
        )
    };
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Both papers, here</title><style>{STYLE}</style></head>\n\
         <body><h1>Both papers, here</h1>\n<table><thead><tr><th>paper</th><th>item</th><th>reported there</th><th>here</th>\
         <th>simulator</th><th>claim holds</th></tr></thead><tbody>\n{}</tbody></table>\n{}</body></html>\n",
        rows.iter().map(row).collect::<String>(),
        reports.iter().map(report).collect::<String>(),
    )
}

#[cfg(test)]
mod tests {
    use super::html;
    use jump_lab::papers::Row;

    #[test]
    fn text_does_not_become_markup() {
        let row = Row::new('A', "a < b & c", "1").ours("2", false, "<script>");
        let page = html(&[row], &["one".into()]);
        assert!(page.contains("a &lt; b &amp; c"));
        assert!(!page.contains("<script>"));
        assert!(page.contains("src=\"one/report.html\""));
        assert!(page.contains("class=\"NO\""));
    }
}
