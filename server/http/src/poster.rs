//! Who has something kept, lists it, or removes it: the operator, a known client, or whoever shows the secret that was handed out
//! when something was kept.

use crate::{access::Client, error::ApiError, state::AppState, trust::client_address_of};
use axum::{
    body::Body,
    extract::FromRequestParts,
    http::{HeaderValue, Response, request::Parts},
};
use skyglow_app::{request::Keeping, validation::ValidationCode};
use skyglow_scene::{Account, Owner, Posting, Viewer};

/// The header of requests and answers that carries an owner's secret.
pub(crate) const OWNER_HEADER: &str = "skyglow-owner";
/// Length of a secret, hexadecimal digits.
const SECRET_DIGITS: usize = 32;

/// Who asks.
#[derive(Clone, Debug)]
pub struct Poster {
    account: Account,
    owner: Option<Owner>,
    is_operator: bool,
    is_known: bool,
}

impl FromRequestParts<AppState> for Poster {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Result<Self, ApiError> {
        let by_name = |name: String, is_operator| Self {
            owner: Some(Owner::by_name(&name)),
            account: Account::Name(name),
            is_operator,
            is_known: true,
        };
        match state.access.client(&parts.headers)? {
            Client::Operator => Ok(by_name("operator".to_owned(), true)),
            Client::Key(name) => Ok(by_name(format!("key {name}"), false)),
            Client::Anyone => {
                let proxies = &state.config.trusted_proxies;
                let address = client_address_of(&parts.extensions, &parts.headers, proxies);
                let secret = parts.headers.get(OWNER_HEADER).map(secret_of).transpose()?;
                Ok(Self {
                    account: address.map_or(Account::Nobody, Account::Address),
                    owner: secret.map(Owner::by_secret),
                    is_operator: false,
                    is_known: false,
                })
            }
        }
    }
}

fn secret_of(value: &HeaderValue) -> Result<&str, ApiError> {
    let is_secret = |text: &&str| {
        text.len() == SECRET_DIGITS
            && text.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
    };
    value.to_str().ok().filter(is_secret).ok_or_else(|| {
        let allowed = "32 hexadecimal digits, as this header of an answer had them".to_owned();
        let message = "is no owner's secret".to_owned();
        ApiError::parameter(OWNER_HEADER, "…".to_owned(), allowed, message, ValidationCode::Malformed)
    })
}

impl Poster {
    /// How something of theirs is kept, and the secret that is new where they have no owner's yet.
    ///
    /// # Errors
    /// [`ApiError::KeysOnly`] for what known clients alone may have pinned.
    pub(crate) fn posting(self, keeping: Keeping) -> Result<(Posting, Option<String>), ApiError> {
        if keeping.pinned && !self.is_known {
            return Err(ApiError::KeysOnly);
        }
        let secret = match self.owner {
            Some(_) => None,
            None => Some(Owner::new_secret().map_err(ApiError::internal)?),
        };
        let owner = self.owner.or_else(|| secret.as_deref().map(Owner::by_secret));
        let Keeping { listed, pinned } = keeping;
        Ok((Posting { account: self.account, owner, listed, pinned }, secret))
    }

    /// What they see in lists.
    pub(crate) fn viewer(&self) -> Viewer {
        match self.owner {
            _ if self.is_operator => Viewer::Operator,
            Some(owner) => Viewer::Owner(owner),
            None => Viewer::Anyone,
        }
    }

    /// The owner that they are; None for the operator, who may remove everything.
    ///
    /// # Errors
    /// [`ApiError::Unauthorized`] where they are nobody's.
    pub(crate) fn remover(&self) -> Result<Option<Owner>, ApiError> {
        match self.owner {
            _ if self.is_operator => Ok(None),
            Some(owner) => Ok(Some(owner)),
            None => Err(ApiError::Unauthorized),
        }
    }
}

/// Hands out a secret.
pub(crate) fn hand_out(response: &mut Response<Body>, secret: Option<String>) {
    if let Some(value) = secret.and_then(|secret| HeaderValue::from_str(&secret).ok()) {
        response.headers_mut().insert(OWNER_HEADER, value);
    }
}
