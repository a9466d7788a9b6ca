//! Flights by closed forms against an integration with 256 bits.
