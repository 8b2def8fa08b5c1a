//! The tags of an XML text one after another, without its content: what the headers of VTK and
//! OME-TIFF need. Content is passed over, not kept, however long it is.

use std::io::{self, BufRead, Read};

/// Longest tag that is read.
const MAX_TAG: u64 = 1 << 16;

/// Whether a tag begins or ends an element, or is all of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Begin,
    End,
    Empty,
}

/// One tag.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Tag {
    pub(crate) kind: Kind,
    /// Name of the element, without the prefix of a namespace.
    pub(crate) name: String,
    attributes: Vec<(String, String)>,
}

impl Tag {
    /// The value of an attribute.
    pub(crate) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }
}

/// Reads tags from a text.
pub(crate) struct Tags<R> {
    reader: R,
    position: u64,
}

impl<R: BufRead> Tags<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, position: 0 }
    }

    /// Bytes read so far: up to the end of the last tag.
    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    /// The next tag; `None` at the end of the text, [`io::ErrorKind::InvalidData`] when it is no XML.
    pub(crate) fn next(&mut self) -> io::Result<Option<Tag>> {
        loop {
            if !self.skip_past(b'<')? {
                return Ok(None);
            }
            let mut text = self.until(b'>')?;
            if text.starts_with(b"!--") {
                self.finish(&mut text, b"--")?;
            } else if text.starts_with(b"![CDATA[") {
                self.finish(&mut text, b"]]")?;
            } else if text.starts_with(b"!") || text.starts_with(b"?") {
                // A document type or an instruction.
            } else {
                while text.iter().fold(0, |quote, byte| inside(quote, *byte)) != 0 {
                    self.more(&mut text)?;
                }
                return parse(&String::from_utf8_lossy(&text)).map(Some).ok_or_else(damaged);
            }
        }
    }

    /// Reads past the next `byte`; false when there is none.
    pub(crate) fn skip_past(&mut self, byte: u8) -> io::Result<bool> {
        loop {
            let buffer = self.reader.fill_buf()?;
            if buffer.is_empty() {
                return Ok(false);
            }
            let found = buffer.iter().position(|b| *b == byte);
            let used = found.map_or(buffer.len(), |place| place + 1);
            self.reader.consume(used);
            self.position += used as u64;
            if found.is_some() {
                return Ok(true);
            }
        }
    }

    /// The bytes up to `end`, which is read and left out.
    fn until(&mut self, end: u8) -> io::Result<Vec<u8>> {
        let mut text = Vec::new();
        let count = self.reader.by_ref().take(MAX_TAG).read_until(end, &mut text)?;
        self.position += count as u64;
        match text.pop() {
            Some(last) if last == end => Ok(text),
            _ => Err(damaged()),
        }
    }

    /// Appends what follows the `>` at which `text` was cut.
    fn more(&mut self, text: &mut Vec<u8>) -> io::Result<()> {
        text.push(b'>');
        text.extend(self.until(b'>')?);
        if text.len() as u64 > MAX_TAG { Err(damaged()) } else { Ok(()) }
    }

    /// Reads on until `text`, of which only the end is kept, ends with `end`.
    fn finish(&mut self, text: &mut Vec<u8>, end: &[u8]) -> io::Result<()> {
        while !text.ends_with(end) {
            *text = self.until(b'>')?;
        }
        Ok(())
    }
}

/// The quote that is open after `byte`, 0 if none.
fn inside(quote: u8, byte: u8) -> u8 {
    match byte {
        b'"' | b'\'' if quote == 0 => byte,
        _ if byte == quote => 0,
        _ => quote,
    }
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the XML is damaged")
}

/// What stands between `<` and `>`.
fn parse(text: &str) -> Option<Tag> {
    let (kind, text) = match (text.strip_prefix('/'), text.strip_suffix('/')) {
        (Some(text), _) => (Kind::End, text),
        (None, Some(text)) => (Kind::Empty, text),
        (None, None) => (Kind::Begin, text),
    };
    let (name, mut rest) = text.split_once(|c: char| c.is_whitespace()).unwrap_or((text, ""));
    if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        return None;
    }
    let mut attributes = Vec::new();
    while !rest.trim_start().is_empty() {
        let (key, value) = rest.split_once('=')?;
        let value = value.trim_start();
        let quote = value.chars().next().filter(|quote| ['"', '\''].contains(quote))?;
        let (value, after) = value[1..].split_once(quote)?;
        attributes.push((local(key.trim()), unescape(value)));
        rest = after;
    }
    Some(Tag { kind, name: local(name), attributes })
}

/// A name without its prefix.
fn local(name: &str) -> String {
    name.rsplit(':').next().unwrap_or(name).into()
}

/// The text that a value with entities stands for; those that are not known stay.
fn unescape(value: &str) -> String {
    let mut text = String::new();
    let mut rest = value;
    while let Some((before, after)) = rest.split_once('&') {
        text.push_str(before);
        let entity = after.split_once(';').and_then(|(entity, after)| {
            let known = match entity {
                "lt" => '<',
                "gt" => '>',
                "amp" => '&',
                "quot" => '"',
                "apos" => '\'',
                _ => char::from_u32(match entity.strip_prefix("#x") {
                    Some(code) => u32::from_str_radix(code, 16).ok()?,
                    None => entity.strip_prefix('#')?.parse().ok()?,
                })?,
            };
            Some((known, after))
        });
        let (c, after) = entity.unwrap_or(('&', after));
        text.push(c);
        rest = after;
    }
    text.push_str(rest);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tags(text: &str) -> io::Result<Vec<Tag>> {
        let mut tags = Tags::new(text.as_bytes());
        std::iter::from_fn(|| tags.next().transpose()).collect()
    }

    #[test]
    fn tags_come_in_order_with_their_attributes() {
        let text = "<?xml version=\"1.0\"?>\n<!-- <no> -- > --><A x='1'\n y = \"a&gt;&#xb5;&amp;&c>d\">text\
            <![CDATA[<b> ]] > ]]><ome:B n='\"'/></A >";
        let found = tags(text).unwrap();
        let shape: Vec<_> = found.iter().map(|tag| (tag.kind, tag.name.as_str())).collect();
        assert_eq!(shape, [(Kind::Begin, "A"), (Kind::Empty, "B"), (Kind::End, "A")]);
        assert_eq!((found[0].get("x"), found[0].get("y")), (Some("1"), Some("a>µ&&c>d")));
        assert_eq!((found[1].get("n"), found[1].get("x")), (Some("\""), None));
    }

    #[test]
    fn positions_are_those_after_the_tag() {
        let mut tags = Tags::new(&b"<a b='>'>data</a>"[..]);
        tags.next().unwrap();
        assert_eq!(tags.position(), 9);
    }

    #[test]
    fn what_is_no_xml_is_refused() {
        for text in ["<a", "<a b>", "<a b=1>", "<a b='1>", "<!-- x", "< a>", "<1>"] {
            assert!(tags(text).is_err(), "{text}");
        }
        let endless = format!("<a {}>", " ".repeat(1 << 17));
        assert!(tags(&endless).is_err());
    }
}
