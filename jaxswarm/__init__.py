"""Finds the physical effect a robot model lacks; on a swarm engine for JAX."""
