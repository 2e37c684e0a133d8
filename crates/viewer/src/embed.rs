//! JSON inside HTML: text that no browser takes for markup, however hostile the names in it.

/// Makes JSON text safe inside a `<script>` element.
///
/// `<`, `>` and `&` become escapes (so neither `</script>` nor `<!--` can occur), as do U+2028 and
/// U+2029, which older scripts take for line ends. In JSON these characters occur in strings only,
/// where an escape means the same.
pub(crate) fn script_safe(json: &str) -> String {
    let mut safe = String::with_capacity(json.len() + json.len() / 16);
    for c in json.chars() {
        match c {
            '<' => safe.push_str("\\u003c"),
            '>' => safe.push_str("\\u003e"),
            '&' => safe.push_str("\\u0026"),
            '\u{2028}' => safe.push_str("\\u2028"),
            '\u{2029}' => safe.push_str("\\u2029"),
            c => safe.push(c),
        }
    }
    safe
}

/// Makes text safe as an HTML element's content.
pub(crate) fn text_safe(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Fills `{{name}}` marks in one pass: what is put in is never itself searched for marks.
///
/// Unknown marks stay as they are.
pub(crate) fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let mut filled = String::with_capacity(template.len() + parts.iter().map(|(_, text)| text.len()).sum::<usize>());
    let mut rest = template;
    while let Some(open) = rest.find("{{") {
        let (before, from_mark) = rest.split_at(open);
        filled.push_str(before);
        let part = from_mark
            .find("}}")
            .and_then(|close| Some((close, parts.iter().find(|(name, _)| *name == &from_mark[2..close])?.1)));
        match part {
            Some((close, text)) => {
                filled.push_str(text);
                rest = &from_mark[close + 2..];
            }
            None => {
                filled.push_str("{{");
                rest = &from_mark[2..];
            }
        }
    }
    filled.push_str(rest);
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_json_stays_json_and_is_no_markup() {
        let hostile = serde_json::json!({"a": "</script><!-- & \u{2028}\u{2029} <script>"});
        let safe = script_safe(&hostile.to_string());
        assert!(!safe.contains(['<', '>', '&', '\u{2028}', '\u{2029}']), "{safe}");
        assert_eq!(serde_json::from_str::<serde_json::Value>(&safe).ok(), Some(hostile));
    }

    #[test]
    fn what_is_filled_in_is_not_searched() {
        assert_eq!(fill("a {{x}} b {{y}} {{z}} {{", &[("x", "{{y}}"), ("y", "1")]), "a {{y}} b 1 {{z}} {{");
    }
}
