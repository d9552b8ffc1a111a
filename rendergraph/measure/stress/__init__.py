"""`rg stress`: what a graph does at the numerical extremes."""
