"""Filters that compute their covariance as they go: each is a Stepper."""
