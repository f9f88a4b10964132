{{- define "skyglow.labels" -}}
app.kubernetes.io/name: skyglow
app.kubernetes.io/instance: {{ .Release.Name }}
{{- end -}}
