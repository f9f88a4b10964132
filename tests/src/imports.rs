//! What a Rust file imports: the paths that it names, read from its tokens.

use crate::tree::SourceFile;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::{BTreeMap, BTreeSet};

/// The path of a module or an item from the crate's root, without `crate`.
pub(crate) type ItemPath = Vec<String>;

/// A file of a crate as a module.
#[derive(Debug, Default)]
pub(crate) struct Module {
    pub(crate) file: String,
    pub(crate) path: ItemPath,
    /// Modules declared in the file, in other files or inline.
    children: BTreeSet<String>,
    /// Modules and files for tests alone.
    pub(crate) test_modules: Vec<ItemPath>,
    pub(crate) test_files: Vec<String>,
    /// What each name brought in by `use` stands for.
    pub(crate) imports: BTreeMap<String, ItemPath>,
    /// Names of re-exports with their paths: edges where the file uses the name itself.
    pub(crate) re_exports: Vec<(String, ItemPath)>,
    /// All other paths named.
    pub(crate) named: BTreeSet<ItemPath>,
    /// How often each identifier stands in the file.
    pub(crate) identifiers: BTreeMap<String, usize>,
}

impl Module {
    /// Reads a file.
    ///
    /// # Panics
    /// Where it is not Rust.
    pub(crate) fn read(file: &SourceFile, path: ItemPath) -> Self {
        let tokens: TokenStream = file.text.parse().unwrap_or_else(|e| panic!("{}: {e}", file.path));
        let mut module = Self { file: file.path.clone(), path: path.clone(), ..Self::default() };
        module.declarations(tokens.clone());
        module.walk(tokens, &path);
        module
    }

    /// Names of the modules that the file declares.
    fn declarations(&mut self, tokens: TokenStream) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        for pair in tokens.windows(2) {
            if let [TokenTree::Ident(word), TokenTree::Ident(name)] = pair
                && word == "mod"
            {
                self.children.insert(name.to_string());
            }
        }
    }

    fn walk(&mut self, tokens: TokenStream, scope: &[String]) {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < tokens.len() {
            at = match &tokens[at] {
                TokenTree::Punct(sign) if sign.as_char() == '#' && is_test_attribute(tokens.get(at + 1)) => {
                    self.skip_test_item(&tokens, at + 2, scope)
                }
                TokenTree::Ident(word) if word == "mod" => match (tokens.get(at + 1), tokens.get(at + 2)) {
                    (Some(TokenTree::Ident(name)), Some(TokenTree::Group(body))) => {
                        self.walk(body.stream(), &[scope, &[name.to_string()]].concat());
                        at + 3
                    }
                    _ => at + 2,
                },
                TokenTree::Ident(word) if word == "use" => {
                    let is_public = at > 0 && is_visibility(&tokens[..at]);
                    self.path_tree(&tokens, at + 1, &[], true, &mut |module, path, name| {
                        module.import(path, name, scope, is_public);
                    })
                }
                TokenTree::Ident(_) => self.path_tree(&tokens, at, &[], false, &mut |module, path, _| {
                    if path.len() > 1 {
                        module.named.extend(module.absolute(path, scope));
                    }
                }),
                TokenTree::Group(group) => {
                    self.walk(group.stream(), scope);
                    at + 1
                }
                _ => at + 1,
            };
        }
    }

    /// Reads `a::b`, `a::{b, c::*}` or `a::b as c` that starts at a place, calls `found` with each path and the name that
    /// it brings in (`*` for all), and returns where it ends.
    fn path_tree(
        &mut self,
        tokens: &[TokenTree],
        start: usize,
        prefix: &[String],
        in_use: bool,
        found: &mut dyn FnMut(&mut Self, &[String], &str),
    ) -> usize {
        let mut path = prefix.to_vec();
        let mut at = start;
        loop {
            match tokens.get(at) {
                Some(TokenTree::Ident(word)) => {
                    let word = word.to_string();
                    *self.identifiers.entry(word.clone()).or_default() += 1;
                    if word != "self" || path.is_empty() {
                        path.push(word);
                    }
                    at += 1;
                }
                Some(TokenTree::Punct(sign)) if sign.as_char() == '*' => {
                    found(self, &path, "*");
                    return at + 1;
                }
                Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Brace => {
                    let inner: Vec<TokenTree> = group.stream().into_iter().collect();
                    let mut inside = 0;
                    while inside < inner.len() {
                        let end = self.path_tree(&inner, inside, &path, in_use, found);
                        inside = end.max(inside + 1);
                    }
                    return at + 1;
                }
                _ => {
                    // What follows `::` is no name: `a::b::<T>()`.
                    if at > start {
                        found(self, &path, "");
                    }
                    return at;
                }
            }
            if is_sign(tokens.get(at), ':') && is_sign(tokens.get(at + 1), ':') {
                at += 2;
                continue;
            }
            let alias = match (tokens.get(at), tokens.get(at + 1)) {
                (Some(TokenTree::Ident(word)), Some(TokenTree::Ident(alias))) if in_use && word == "as" => {
                    at += 2;
                    Some(alias.to_string())
                }
                _ => None,
            };
            let name = alias.or_else(|| path.last().cloned()).unwrap_or_default();
            found(self, &path, &name);
            return at;
        }
    }

    fn import(&mut self, path: &[String], name: &str, scope: &[String], is_public: bool) {
        let Some(path) = self.absolute(path, scope) else { return };
        if scope == self.path && name != "*" {
            self.imports.insert(name.to_owned(), path.clone());
        }
        if is_public && name != "*" {
            self.re_exports.push((name.to_owned(), path));
        } else {
            self.named.insert(path);
        }
    }

    /// A path from the crate's root; None for what another crate has.
    fn absolute(&self, path: &[String], scope: &[String]) -> Option<ItemPath> {
        let mut base = scope.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => (base, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|word| word == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            child if self.children.contains(child) => base = self.path.clone(),
            _ => return None,
        }
        Some([base.as_slice(), rest].concat())
    }

    /// Passes over an item for tests alone, from behind its `#[cfg(test)]`; notes the module that it declares.
    fn skip_test_item(&mut self, tokens: &[TokenTree], start: usize, scope: &[String]) -> usize {
        let mut at = start;
        let mut file = None;
        while is_sign(tokens.get(at), '#') {
            let text = tokens.get(at + 1).map(ToString::to_string).unwrap_or_default();
            if text.starts_with("[path") {
                file = text.split('"').nth(1).map(str::to_owned);
            }
            at += 2;
        }
        let mut ends_at_braces = true;
        while let Some(token) = tokens.get(at) {
            match token {
                TokenTree::Ident(word)
                    if ["use", "const", "static", "type", "let"].iter().any(|w| word == w) =>
                {
                    ends_at_braces = false;
                }
                TokenTree::Ident(word) if word == "mod" && is_sign(tokens.get(at + 2), ';') => match &file {
                    Some(name) => {
                        let folder = &self.file[..self.file.rfind('/').map_or(0, |slash| slash + 1)];
                        self.test_files.push(format!("{folder}{name}"));
                    }
                    None => {
                        let name = tokens[at + 1].to_string();
                        self.test_modules.push([scope, &[name]].concat());
                    }
                },
                TokenTree::Punct(sign) if sign.as_char() == ';' => return at + 1,
                TokenTree::Group(group) if ends_at_braces && group.delimiter() == Delimiter::Brace => {
                    return at + 1;
                }
                _ => {}
            }
            at += 1;
        }
        at
    }
}

fn is_sign(token: Option<&TokenTree>, sign: char) -> bool {
    matches!(token, Some(TokenTree::Punct(punct)) if punct.as_char() == sign)
}

fn is_test_attribute(token: Option<&TokenTree>) -> bool {
    token.is_some_and(|token| token.to_string().replace(' ', "") == "[cfg(test)]")
}

/// Whether the tokens end with `pub` or `pub(…)`.
fn is_visibility(before: &[TokenTree]) -> bool {
    let is_pub = |token: Option<&TokenTree>| matches!(token, Some(TokenTree::Ident(word)) if word == "pub");
    match before {
        [.., word, TokenTree::Group(_)] => is_pub(Some(word)),
        _ => is_pub(before.last()),
    }
}
