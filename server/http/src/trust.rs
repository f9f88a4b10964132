//! Whose word is taken for where a request comes from and how the client reached the server: that of trusted proxies, in
//! `X-Forwarded-*` or `Forwarded` (RFC 7239).

use crate::{config::HttpConfig, listener::Ends};
use axum::{
    extract::ConnectInfo,
    http::{Extensions, HeaderMap, Request, header},
};
use ipnet::IpNet;
use std::net::{IpAddr, Ipv6Addr, SocketAddr};

/// Longest prefix of paths that is believed, bytes.
const MAX_PREFIX_BYTES: usize = 256;

/// Whether an address is one of a proxy that says whom it speaks for.
pub(crate) fn is_trusted(address: IpAddr, proxies: &[IpNet]) -> bool {
    let address = address.to_canonical();
    proxies.iter().any(|network| network.contains(&address))
}

/// The client's address: that of the connection or, where a trusted proxy made it, the last one named that is no such proxy's.
/// None where the system does not say.
pub(crate) fn client_address<B>(request: &Request<B>, proxies: &[IpNet]) -> Option<IpAddr> {
    client_address_of(request.extensions(), request.headers(), proxies)
}

/// The same of a request that is taken apart.
pub(crate) fn client_address_of(
    extensions: &Extensions,
    headers: &HeaderMap,
    proxies: &[IpNet],
) -> Option<IpAddr> {
    passed_on(extensions, headers, proxies).map(|(client, _)| client)
}

/// The client's address, and how many trusted proxies passed the request on.
fn passed_on(extensions: &Extensions, headers: &HeaderMap, proxies: &[IpNet]) -> Option<(IpAddr, usize)> {
    let connected = extensions.get::<ConnectInfo<Ends>>()?.0.client.ip();
    let old: Vec<Option<IpAddr>> =
        list(headers, "x-forwarded-for").iter().map(|text| address(text)).collect();
    let new: Vec<Option<IpAddr>> = forwarded(headers)
        .iter()
        .map(|element| field(element, "for").and_then(|text| address(&text)))
        .collect();
    let walk = |named: &[Option<IpAddr>]| {
        let (mut address, mut hops) = (connected, 0);
        for name in named.iter().rev() {
            if !is_trusted(address, proxies) {
                return (address, hops);
            }
            hops += 1;
            // A proxy that says nonsense is taken for the client.
            let Some(before) = *name else { return (address, hops) };
            address = before;
        }
        (address, hops + usize::from(is_trusted(address, proxies)))
    };
    let (by_old, by_new) = (walk(&old), walk(&new));
    match (old.is_empty(), new.is_empty()) {
        (false, true) => Some(by_old),
        (true, _) => Some(by_new),
        // A proxy writes one of them and hands on the other as the client sent it: where they differ, neither is believed.
        (false, false) if by_old.0 == by_new.0 => Some(by_old),
        (false, false) => Some((connected, usize::from(is_trusted(connected, proxies)))),
    }
}

/// Where the client reached the server.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PublicAddress {
    /// Scheme and authority, such as `https://sky.example.org`; empty where nobody knows.
    origin: String,
    /// What stands before all paths, such as `/skyglow`; empty where nothing does.
    prefix: String,
    /// Whether that is more than the connection itself says.
    is_told: bool,
}

impl PublicAddress {
    /// What is configured; else what trusted proxies say; else the Host header if it is a host; else the address that the
    /// connection came to.
    pub(crate) fn of(headers: &HeaderMap, extensions: &Extensions, config: &HttpConfig) -> Self {
        if let Some(url) = &config.public_url {
            return Self::from_url(url);
        }
        let hops = passed_on(extensions, headers, &config.trusted_proxies).map_or(0, |(_, hops)| hops);
        // Each trusted proxy adds to the end of a list or writes the whole: the outermost of them saw the client.
        let outermost = |mut values: Vec<String>| {
            (hops > 0 && !values.is_empty()).then(|| values.swap_remove(values.len().saturating_sub(hops)))
        };
        let element = outermost(forwarded(headers));
        let told =
            |old: &str, new: &str| outermost(list(headers, old)).or_else(|| field(element.as_deref()?, new));
        let scheme = told("x-forwarded-proto", "proto").map(|scheme| scheme.to_ascii_lowercase());
        let scheme = scheme.filter(|scheme| scheme == "http" || scheme == "https");
        let host = told("x-forwarded-host", "host").filter(|host| is_host(host));
        let prefix = outermost(list(headers, "x-forwarded-prefix")).and_then(|prefix| prefix_of(&prefix));
        let is_told = scheme.is_some() || host.is_some() || prefix.is_some();
        let named = || {
            let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
            host.filter(|host| is_host(host)).map(str::to_owned)
        };
        let reached = || {
            let ends = extensions.get::<ConnectInfo<Ends>>()?.0;
            ends.server.map(|address: SocketAddr| address.to_string())
        };
        let scheme = scheme.as_deref().unwrap_or("http");
        let authority = host.or_else(named).or_else(reached);
        Self {
            origin: authority.map_or_else(String::new, |authority| format!("{scheme}://{authority}")),
            prefix: prefix.unwrap_or_default(),
            is_told,
        }
    }

    fn from_url(url: &str) -> Self {
        let url = url.trim_end_matches('/');
        let authority = url.find("://").map_or(0, |at| at + 3);
        let end = url[authority..].find('/').map_or(url.len(), |at| authority + at);
        Self { origin: url[..end].to_owned(), prefix: url[end..].to_owned(), is_told: true }
    }

    /// What all addresses begin with: a link is this and a path.
    pub(crate) fn base(&self) -> String {
        format!("{}{}", self.origin, self.prefix)
    }

    /// The same for a document that is kept and read elsewhere: `/` where the client alone knows.
    pub(crate) fn server_url(&self) -> String {
        if self.is_told { format!("{}/", self.base()) } else { "/".to_owned() }
    }

    /// A path as the client must ask for it.
    pub(crate) fn path(&self, path: &str) -> String {
        format!("{}{path}", self.prefix)
    }

    /// Whether an `Origin` header names this server.
    pub(crate) fn is_origin(&self, origin: &str) -> bool {
        !self.origin.is_empty() && self.origin.eq_ignore_ascii_case(origin)
    }
}

/// The entries of a list in one header or several.
fn list(headers: &HeaderMap, name: &str) -> Vec<String> {
    let values = headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
    let entries = values.flat_map(|value| split(value, ','));
    entries.map(|entry| entry.trim().to_owned()).filter(|entry| !entry.is_empty()).collect()
}

/// The elements of `Forwarded`, one a proxy.
fn forwarded(headers: &HeaderMap) -> Vec<String> {
    list(headers, header::FORWARDED.as_str())
}

/// Splits a text where a sign stands outside of quotes.
fn split(text: &str, at: char) -> Vec<&str> {
    let mut is_quoted = false;
    text.split(move |sign: char| {
        is_quoted ^= sign == '"';
        sign == at && !is_quoted
    })
    .collect()
}

/// A field of an element of `Forwarded`, without its quotes.
fn field(element: &str, name: &str) -> Option<String> {
    split(element, ';').into_iter().find_map(|pair| {
        let (key, value) = pair.split_once('=')?;
        let value = value.trim();
        let value = value.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).unwrap_or(value);
        key.trim().eq_ignore_ascii_case(name).then(|| value.to_owned())
    })
}

/// An address with a port or without.
fn address(text: &str) -> Option<IpAddr> {
    let bare = text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(text);
    bare.parse().ok().or_else(|| text.parse::<SocketAddr>().ok().map(|address| address.ip()))
}

/// A prefix of paths that may stand in a link: segments of plain letters after a slash each, without the last slash.
fn prefix_of(text: &str) -> Option<String> {
    let prefix = text.trim_end_matches('/');
    let is_plain = |segment: &str| {
        !segment.is_empty()
            && segment != "."
            && segment != ".."
            && segment.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte))
    };
    let mut segments = prefix.split('/');
    let is_prefix = prefix.len() <= MAX_PREFIX_BYTES && segments.next() == Some("") && segments.all(is_plain);
    (is_prefix || prefix.is_empty()).then(|| prefix.to_owned())
}

/// Whether a text is a name or an address with a port or without, and nothing else that an authority may be: its
/// letters go into addresses that other programs put together.
fn is_host(text: &str) -> bool {
    let (host, port) = match text.rsplit_once(':') {
        Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
        _ => (text, None),
    };
    let is_port = |port: &str| port.bytes().all(|b| b.is_ascii_digit()) && port.parse::<u16>().is_ok();
    let is_name = |name: &str| {
        (1..=253).contains(&name.len())
            && name.trim_end_matches('.').split('.').all(|label| {
                (1..=63).contains(&label.len())
                    && label.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_')
            })
    };
    let is_address = match host.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        Some(address) => address.parse::<Ipv6Addr>().is_ok(),
        None => is_name(host),
    };
    is_address && port.is_none_or(is_port)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn proxies() -> Vec<IpNet> {
        vec!["10.0.0.0/8".parse().unwrap(), "fd00::/8".parse().unwrap()]
    }

    fn request(connection: &str, headers: &[(&'static str, &str)]) -> Request<()> {
        let client: SocketAddr = connection.parse().unwrap();
        let mut request = Request::builder();
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let mut request = request.body(()).unwrap();
        let server = Some(SocketAddr::from(([10, 0, 0, 7], 8080)));
        request.extensions_mut().insert(ConnectInfo(Ends { client, server }));
        request
    }

    /// A header is believed from trusted proxies alone and as far as they go.
    #[test]
    fn only_trusted_proxies_are_believed() {
        let client = |connection: &str, forwarded: &[&str]| {
            let headers: Vec<_> = forwarded.iter().map(|value| ("x-forwarded-for", *value)).collect();
            client_address(&request(connection, &headers), &proxies()).unwrap().to_string()
        };
        assert_eq!(client("203.0.113.7:5", &["1.2.3.4"]), "203.0.113.7");
        assert_eq!(client("10.1.1.1:5", &[]), "10.1.1.1");
        assert_eq!(client("10.1.1.1:5", &["1.2.3.4"]), "1.2.3.4");
        // What the client itself put in front is no proxy's word.
        assert_eq!(client("10.1.1.1:5", &["9.9.9.9, 1.2.3.4, 10.2.2.2"]), "1.2.3.4");
        assert_eq!(client("10.1.1.1:5", &["9.9.9.9", "1.2.3.4"]), "1.2.3.4");
        assert_eq!(client("10.1.1.1:5", &["unknown"]), "10.1.1.1");
        assert_eq!(client("[::ffff:10.1.1.1]:5", &["2001:db8::1"]), "2001:db8::1");
        assert_eq!(client("10.1.1.1:5", &["1.2.3.4:5678"]), "1.2.3.4");
    }

    #[test]
    fn forwarded_names_the_client_too() {
        let client = |headers: &[(&'static str, &str)]| {
            client_address(&request("10.1.1.1:5", headers), &proxies()).unwrap().to_string()
        };
        assert_eq!(client(&[("forwarded", "for=1.2.3.4")]), "1.2.3.4");
        assert_eq!(client(&[("forwarded", "For=\"[2001:db8::1]:4711\";proto=https")]), "2001:db8::1");
        assert_eq!(
            client(&[("forwarded", "for=9.9.9.9, for=\"1.2.3.4:80\";by=\"a,b;c\", for=10.2.2.2")]),
            "1.2.3.4"
        );
        assert_eq!(client(&[("forwarded", "for=_hidden")]), "10.1.1.1");
        assert_eq!(client(&[("forwarded", "for=1.2.3.4"), ("x-forwarded-for", "1.2.3.4")]), "1.2.3.4");
        // One of them is the client's own word.
        assert_eq!(client(&[("forwarded", "for=9.9.9.9"), ("x-forwarded-for", "1.2.3.4")]), "10.1.1.1");
    }

    fn public(connection: &str, headers: &[(&'static str, &str)], url: Option<&str>) -> PublicAddress {
        let request = request(connection, headers);
        let public_url = url.map(str::to_owned);
        let config = HttpConfig { trusted_proxies: proxies(), public_url, ..HttpConfig::default() };
        PublicAddress::of(request.headers(), request.extensions(), &config)
    }

    #[test]
    fn links_are_as_trusted_proxies_say() {
        let told = [
            ("host", "upstream:8080"),
            ("x-forwarded-for", "1.2.3.4"),
            ("x-forwarded-proto", "https"),
            ("x-forwarded-host", "sky.example.org"),
            ("x-forwarded-prefix", "/skyglow/"),
        ];
        let trusted = public("10.1.1.1:5", &told, None);
        assert_eq!(trusted.base(), "https://sky.example.org/skyglow");
        assert_eq!(trusted.server_url(), "https://sky.example.org/skyglow/");
        assert_eq!(trusted.path("/api"), "/skyglow/api");
        assert!(trusted.is_origin("https://sky.example.org") && !trusted.is_origin("http://sky.example.org"));
        let stranger = public("203.0.113.7:5", &told, None);
        assert_eq!((stranger.base(), stranger.server_url()), ("http://upstream:8080".into(), "/".into()));
        let configured = public("203.0.113.7:5", &told, Some("https://other.example/a/b/"));
        assert_eq!(
            (configured.base(), configured.path("/x")),
            ("https://other.example/a/b".into(), "/a/b/x".into())
        );
        let element = ("forwarded", "for=1.2.3.4;proto=https;host=\"sky.example.org:8443\"");
        assert_eq!(public("10.1.1.1:5", &[element], None).base(), "https://sky.example.org:8443");
    }

    /// A chain of proxies: what the client wrote in front is nobody's word.
    #[test]
    fn links_are_as_the_outermost_proxy_saw() {
        let base = |headers: &[(&'static str, &str)]| public("10.1.1.1:5", headers, None).base();
        let chain = ("x-forwarded-for", "6.6.6.6, 1.2.3.4, 10.2.2.2");
        let host = ("x-forwarded-host", "evil.example, sky.example, inner.example");
        assert_eq!(base(&[chain, host, ("x-forwarded-proto", "http, https, http")]), "https://sky.example");
        assert_eq!(
            base(&[("x-forwarded-host", "a.example"), ("x-forwarded-proto", "HTTPS")]),
            "https://a.example"
        );
    }

    #[test]
    fn prefixes_that_are_no_paths_are_not_repeated() {
        for nasty in
            ["skyglow", "//evil.example", "/a//b", "/../x", "/a b", "/a?x", "/a\"b", "/<b>", "/{z}", "/a\\b"]
        {
            assert_eq!(prefix_of(nasty), None, "{nasty}");
        }
        assert_eq!(prefix_of("/").as_deref(), Some(""));
        assert_eq!(prefix_of("/a/b.c-d_e~f/").as_deref(), Some("/a/b.c-d_e~f"));
    }

    #[test]
    fn a_host_that_is_none_is_not_repeated() {
        let with = |host: &[u8]| {
            let mut request = request("203.0.113.7:5", &[]);
            request.headers_mut().insert(header::HOST, HeaderValue::from_bytes(host).unwrap());
            PublicAddress::of(request.headers(), request.extensions(), &HttpConfig::default()).base()
        };
        for host in [
            "localhost:8080",
            "sky.example.org",
            "a_b-c.example:80",
            "[::1]:8080",
            "[2001:db8::1]",
            "10.1.2.3",
        ] {
            assert_eq!(with(host.as_bytes()), format!("http://{host}"));
        }
        for nasty in [
            "a\"b<script>",
            "user@evil",
            "evil/path",
            "evil?x=",
            "evil#x",
            "evil\\x",
            "a';alert(1)//",
            "a b",
            "a,b",
            "{z}",
            "[::1",
            "[zz]",
            ":80",
            "host:99999",
            "host:+80",
            "host:80:90",
            "..",
            "a..b",
            "",
            "höst",
        ] {
            assert_eq!(with(nasty.as_bytes()), "http://10.0.0.7:8080", "{nasty}");
        }
        let nobody = PublicAddress::of(&HeaderMap::new(), &Extensions::new(), &HttpConfig::default());
        assert_eq!(nobody.base(), "");
    }
}
