"""NAME_bus: what stands between the core and a host's bus."""
