"""A bench on the live page: what is shown of it, what the page may request, and its own ground station."""
