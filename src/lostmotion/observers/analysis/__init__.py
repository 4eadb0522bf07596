"""Analysis of observers: noise covariances from a recording, standard deviations of the estimates."""
