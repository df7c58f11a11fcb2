"""Two bodies: the descent of their trees, containment, separating planes, what a search remembers."""
