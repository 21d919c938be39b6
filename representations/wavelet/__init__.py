"""The multiresolution wavelet B-spline."""
