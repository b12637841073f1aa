"""What all transports share: the interfaces of sources and sinks, their records, and how messages decode."""
