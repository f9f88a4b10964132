//! What shines in the night sky, part by part.

use serde::Serialize;

/// A part of the light that comes from outside the air. Cities are not among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub enum Component {
    /// The Sun, from below the horizon too: twilight is its light.
    Sun,
    /// The Moon.
    Moon,
    /// Mercury to Neptune.
    Planets,
    /// The 8 404 stars to V = 6.5.
    Stars,
    /// Fainter stars, and the light that they give to dust: the Milky Way.
    Starlight,
    /// Sunlight from dust between the planets, with the gegenschein.
    ZodiacalLight,
    /// Light of the upper air itself.
    Airglow,
}

impl Component {
    /// All.
    pub const ALL: [Component; 7] = [
        Component::Sun,
        Component::Moon,
        Component::Planets,
        Component::Stars,
        Component::Starlight,
        Component::ZodiacalLight,
        Component::Airglow,
    ];

    /// Those that have a radiance in every direction.
    pub const EXTENDED: [Component; 3] = [Component::Starlight, Component::ZodiacalLight, Component::Airglow];

    /// Those that are points or small discs.
    pub const BODIES: [Component; 4] =
        [Component::Sun, Component::Moon, Component::Planets, Component::Stars];

    /// The place in [`Self::ALL`].
    pub const fn index(self) -> usize {
        self as usize
    }

    /// The name in requests and answers.
    pub const fn name(self) -> &'static str {
        match self {
            Component::Sun => "sun",
            Component::Moon => "moon",
            Component::Planets => "planets",
            Component::Stars => "stars",
            Component::Starlight => "starlight",
            Component::ZodiacalLight => "zodiacal_light",
            Component::Airglow => "airglow",
        }
    }

    /// Whether it has a radiance in every direction.
    pub fn is_extended(self) -> bool {
        Self::EXTENDED.contains(&self)
    }

    /// What kernels of the component count.
    pub const fn unit(self) -> &'static str {
        match self {
            Component::Sun => "the Sun at 1 au",
            Component::Moon => "the full Moon at its mean distance",
            Component::Planets | Component::Stars => "a star of V = 0",
            Component::Starlight => "S10 at 440 nm",
            Component::ZodiacalLight => "S10 at 500 nm",
            Component::Airglow => "S10 in V",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn components_are_in_their_order() {
        for (place, component) in Component::ALL.into_iter().enumerate() {
            assert_eq!(component.index(), place);
            assert_ne!(component.is_extended(), Component::BODIES.contains(&component));
            assert_eq!(serde_json::to_value(component).unwrap(), component.name());
        }
    }
}
