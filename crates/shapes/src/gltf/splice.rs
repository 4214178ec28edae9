//! JSON written again with the least change: what stays is copied byte by byte from the old text, white space and the
//! text of numbers included; what is new is laid out like its neighbours.

use std::collections::HashSet;

use serde::Serialize;
use serde_json::ser::PrettyFormatter;
use serde_json::{Map, Serializer, Value};

/// `text`, which is valid JSON, changed to say `new`.
pub(super) fn splice(text: &[u8], new: &Value) -> Vec<u8> {
    let mut splicer = Splicer { text, at: 0, out: Vec::with_capacity(text.len()), step: indentation(text) };
    splicer.skip_space();
    splicer.out.extend_from_slice(&text[..splicer.at]);
    splicer.value(new);
    splicer.out.extend_from_slice(&text[splicer.at..]);
    splicer.out
}

/// The white space before the first key, if that has its own line.
fn indentation(text: &[u8]) -> Option<&[u8]> {
    let rest = text.trim_ascii_start().strip_prefix(b"{")?;
    let space = &rest[..rest.len() - rest.trim_ascii_start().len()];
    let line = space.iter().rposition(|b| *b == b'\n')?;
    Some(&space[line + 1..])
}

struct Splicer<'a> {
    text: &'a [u8],
    at: usize,
    out: Vec<u8>,
    /// What each level is indented by, if the text is laid out in lines.
    step: Option<&'a [u8]>,
}

impl<'a> Splicer<'a> {
    fn skip_space(&mut self) -> &'a [u8] {
        let start = self.at;
        while self.text.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        &self.text[start..self.at]
    }

    fn skip_string(&mut self) {
        self.at += 1;
        while self.text[self.at] != b'"' {
            self.at += if self.text[self.at] == b'\\' { 2 } else { 1 };
        }
        self.at += 1;
    }

    fn skip_value(&mut self) -> &'a [u8] {
        let (start, mut depth) = (self.at, 0);
        loop {
            match self.text[self.at] {
                b'"' => self.skip_string(),
                b'{' | b'[' => {
                    depth += 1;
                    self.at += 1;
                }
                b'}' | b']' => {
                    depth -= 1;
                    self.at += 1;
                }
                b',' | b':' => self.at += 1,
                b if b.is_ascii_whitespace() => self.at += 1,
                _ => {
                    let end = |b: &u8| b.is_ascii_whitespace() || b",]}".contains(b);
                    let rest = &self.text[self.at..];
                    self.at += rest.iter().position(end).unwrap_or(rest.len());
                }
            }
            if depth == 0 {
                return &self.text[start..self.at];
            }
        }
    }

    fn value(&mut self, new: &Value) {
        match (self.text[self.at], new) {
            (b'{', Value::Object(members)) => self.object(members),
            (b'[', Value::Array(items)) => self.array(items),
            _ => {
                let old = self.skip_value();
                if serde_json::from_slice::<Value>(old).is_ok_and(|old| old == *new) {
                    self.out.extend_from_slice(old);
                } else {
                    self.print(new, b"");
                }
            }
        }
    }

    fn object(&mut self, members: &Map<String, Value>) {
        let mut seen = HashSet::new();
        // The white space before a key, what is between it and its value, and the comma (none before the first).
        let (mut gap, mut colon, mut comma): (&[u8], &[u8], &[u8]) = (b"", b":", b"");
        self.open();
        let end = loop {
            let space = self.skip_space();
            if self.text[self.at] == b'}' {
                break space;
            }
            gap = space;
            let start = self.at;
            self.skip_string();
            let end = self.at;
            let key: String = serde_json::from_slice(&self.text[start..end]).expect("the text is valid JSON");
            self.skip_space();
            self.at += 1;
            self.skip_space();
            colon = &self.text[end..self.at];
            if let Some(new) = members.get(&key) {
                self.out.extend(
                    [if seen.is_empty() { b"" } else { comma }, gap, &self.text[start..self.at]].concat(),
                );
                self.value(new);
                seen.insert(key);
            } else {
                self.skip_value();
            }
            match self.comma() {
                Ok(text) => comma = text,
                Err(space) => break space,
            }
        };
        for (key, new) in members.iter().filter(|(key, _)| !seen.contains(*key)) {
            let key = Value::from(key.as_str()).to_string();
            let comma: &[u8] = if self.out.ends_with(b"{") { b"" } else { b"," };
            self.out.extend([comma, gap, key.as_bytes(), colon].concat());
            self.print(new, gap);
        }
        self.close(end);
    }

    fn array(&mut self, items: &[Value]) {
        let (mut gap, mut comma, mut count): (&[u8], &[u8], usize) = (b"", b"", 0);
        self.open();
        let end = loop {
            let space = self.skip_space();
            if self.text[self.at] == b']' {
                break space;
            }
            gap = space;
            if let Some(new) = items.get(count) {
                self.out.extend([comma, gap].concat());
                self.value(new);
            } else {
                self.skip_value();
            }
            count += 1;
            match self.comma() {
                Ok(text) => comma = text,
                Err(space) => break space,
            }
        };
        for new in items.iter().skip(count) {
            let comma: &[u8] = if self.out.ends_with(b"[") { b"" } else { b"," };
            self.out.extend([comma, gap].concat());
            self.print(new, gap);
        }
        self.close(end);
    }

    fn open(&mut self) {
        self.out.push(self.text[self.at]);
        self.at += 1;
    }

    fn close(&mut self, space: &[u8]) {
        self.out.extend_from_slice(space);
        self.open();
    }

    /// The comma behind an element, with the white space before it; or the white space before the closing bracket.
    fn comma(&mut self) -> Result<&'a [u8], &'a [u8]> {
        let space = self.skip_space();
        if self.text[self.at] != b',' {
            return Err(space);
        }
        self.at += 1;
        Ok(&self.text[self.at - 1 - space.len()..self.at])
    }

    /// A new value: in lines if `gap`, the white space before it, starts a line.
    fn print(&mut self, new: &Value, gap: &[u8]) {
        let line = gap.iter().rposition(|b| *b == b'\n');
        let (Some(line), Some(step)) = (line, self.step) else {
            self.out.extend(new.to_string().into_bytes());
            return;
        };
        let mut printed = Vec::new();
        let mut to = Serializer::with_formatter(&mut printed, PrettyFormatter::with_indent(step));
        new.serialize(&mut to).expect("a Value can be written to memory");
        let mut line_end = if gap[..line].ends_with(b"\r") { b"\r\n".to_vec() } else { b"\n".to_vec() };
        line_end.extend_from_slice(&gap[line + 1..]);
        // Within strings, line ends are escaped.
        let lines: Vec<&[u8]> = printed.split(|b| *b == b'\n').collect();
        self.out.extend(lines.join(&line_end[..]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    #[test]
    fn only_what_changes_is_written_anew() {
        let old = "{ \"a\" : [ 1.50, {\"x\":\"\\\"]\"} ],\r\n  \"b\" :\t2 ,\r\n \"c\" : null\r\n}\r\n";
        let mut new: Value = serde_json::from_str(old).unwrap();
        assert_eq!(splice(old.as_bytes(), &new), old.as_bytes());
        new["a"][1]["x"] = json!("y");
        new["b"] = json!(3);
        let wanted = old.replace("\"\\\"]\"", "\"y\"").replace('2', "3");
        assert_eq!(String::from_utf8(splice(old.as_bytes(), &new)).unwrap(), wanted);
    }

    #[test]
    fn what_is_added_is_laid_out_like_its_neighbours() {
        let old = "{\n\t\"a\" : [\n\t\t{\n\t\t\t\"n\" : 1\n\t\t}\n\t],\n\t\"gone\" : 0\n}";
        let new = json!({ "a": [{ "n": 1, "m": 2 }, { "n": 3 }] });
        let wanted = "{\n\t\"a\" : [\n\t\t{\n\t\t\t\"n\" : 1,\n\t\t\t\"m\" : 2\n\t\t},\n\t\t{\n\t\t\t\"n\": 3\n\t\t}\n\t]\n}";
        assert_eq!(String::from_utf8(splice(old.as_bytes(), &new)).unwrap(), wanted);
        assert_eq!(splice(b"{}", &json!({ "a": [1, 2] })), b"{\"a\":[1,2]}");
        assert_eq!(splice(b"[[], {\"a\":1 , \"b\":2}]", &json!([[7], { "b": 2 }])), b"[[7], { \"b\":2}]");
    }

    fn tree() -> impl Strategy<Value = Value> {
        let leaf = prop_oneof![
            Just(Value::Null),
            any::<i8>().prop_map(Value::from),
            "[\"\\\\a,}\\]]*".prop_map(Value::from)
        ];
        leaf.prop_recursive(4, 30, 4, |inner| {
            prop_oneof![
                prop::collection::vec(inner.clone(), 0..4).prop_map(Value::from),
                prop::collection::vec(("[ab\":]", inner), 0..4)
                    .prop_map(|m| Value::Object(m.into_iter().collect())),
            ]
        })
    }

    proptest! {
        #[test]
        fn any_text_becomes_any_value(old in tree(), new in tree(), pretty in any::<bool>()) {
            let text = if pretty { serde_json::to_string_pretty(&old).unwrap() } else { old.to_string() };
            prop_assert_eq!(splice(text.as_bytes(), &old), text.as_bytes());
            let changed: Value = serde_json::from_slice(&splice(text.as_bytes(), &new)).unwrap();
            prop_assert_eq!(changed, new);
        }
    }
}
