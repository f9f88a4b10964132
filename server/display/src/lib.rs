//! From a panorama to a picture: projections, colour maps, legends, encoders.
