// From a folder a browser may not read other pages for the excerpts below the results of a search; from a server it may.
if (location.protocol === "file:") DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
