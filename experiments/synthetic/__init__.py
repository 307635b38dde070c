"""Simulated runs whose causes of error are known: data to test model criticism with."""
