"""Predictive control with a search in every sample: ``layout`` of its numbers, the quadratic program of one candidate
(``quadratic_program``), and the step that compares the candidates (``hybrid``)."""
