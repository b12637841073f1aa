"""The common base of all transports: interfaces of sources and sinks, their records, and the decoding of messages."""
