"""Speed, measured: what `pas bench` runs, beside other programs where these are installed."""
