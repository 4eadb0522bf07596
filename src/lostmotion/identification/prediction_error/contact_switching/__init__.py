"""A second estimator: maximum likelihood with a Kalman filter that follows gap and sticking."""
