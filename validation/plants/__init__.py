"""Plants of the sources' other models: not shipped, each beside a way written apart."""
