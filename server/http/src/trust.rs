//! Whose word is taken for where a request comes from.

use crate::listener::Ends;
use axum::{extract::ConnectInfo, http::Request};
use ipnet::IpNet;
use std::net::IpAddr;

/// Whether an address is one of a proxy that says whom it speaks for.
pub(crate) fn is_trusted(address: IpAddr, proxies: &[IpNet]) -> bool {
    let address = address.to_canonical();
    proxies.iter().any(|network| network.contains(&address))
}

/// The client's address: that of the connection or, where a trusted proxy made it, the last one in `X-Forwarded-For` that is no such
/// proxy's. None where the system does not say.
pub(crate) fn client_address<B>(request: &Request<B>, proxies: &[IpNet]) -> Option<IpAddr> {
    let mut address = request.extensions().get::<ConnectInfo<Ends>>()?.0.client.ip();
    let headers = request.headers().get_all("x-forwarded-for");
    let named: Vec<&str> =
        headers.iter().filter_map(|value| value.to_str().ok()).flat_map(|value| value.split(',')).collect();
    for name in named.iter().rev() {
        if !is_trusted(address, proxies) {
            break;
        }
        // A proxy that says nonsense is taken for the client.
        let Ok(before) = name.trim().parse() else { break };
        address = before;
    }
    Some(address)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::SocketAddr;

    /// A header is believed from trusted proxies alone and as far as they go.
    #[test]
    fn only_trusted_proxies_are_believed() {
        let proxies: Vec<IpNet> = vec!["10.0.0.0/8".parse().unwrap(), "fd00::/8".parse().unwrap()];
        let client = |connection: &str, forwarded: &[&str]| {
            let client: SocketAddr = connection.parse().unwrap();
            let mut request = Request::builder();
            for value in forwarded {
                request = request.header("x-forwarded-for", *value);
            }
            let mut request = request.body(()).unwrap();
            request.extensions_mut().insert(ConnectInfo(Ends { client, server: None }));
            client_address(&request, &proxies).unwrap().to_string()
        };
        assert_eq!(client("203.0.113.7:5", &["1.2.3.4"]), "203.0.113.7");
        assert_eq!(client("10.1.1.1:5", &[]), "10.1.1.1");
        assert_eq!(client("10.1.1.1:5", &["1.2.3.4"]), "1.2.3.4");
        // What the client itself put in front is no proxy's word.
        assert_eq!(client("10.1.1.1:5", &["9.9.9.9, 1.2.3.4, 10.2.2.2"]), "1.2.3.4");
        assert_eq!(client("10.1.1.1:5", &["9.9.9.9", "1.2.3.4"]), "1.2.3.4");
        assert_eq!(client("10.1.1.1:5", &["unknown"]), "10.1.1.1");
        assert_eq!(client("[::ffff:10.1.1.1]:5", &["2001:db8::1"]), "2001:db8::1");
    }
}
