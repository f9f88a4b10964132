<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16-Białowieża" styleCategories="Symbology|Labeling">
  <pipe-data-defined-properties>
    <Option type="Map">
      <Option type="QString" value="" name="name"/>
      <Option name="properties"/>
      <Option type="QString" value="collection" name="type"/>
    </Option>
  </pipe-data-defined-properties>
  <pipe>
    <provider>
      <resampling enabled="false" zoomedInResamplingMethod="nearestNeighbour" maxOversampling="2" zoomedOutResamplingMethod="nearestNeighbour"/>
    </provider>
    <rasterrenderer opacity="0.85" band="1" type="singlebandpseudocolor" alphaBand="-1" classificationMax="0.01" classificationMin="0" nodataColor="">
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Estimated</statAccuracy>
        <cumulativeCutLower>0.02</cumulativeCutLower>
        <cumulativeCutUpper>0.98</cumulativeCutUpper>
        <stdDevFactor>2</stdDevFactor>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader maximumValue="0.01" clip="0" colorRampType="DISCRETE" minimumValue="0" labelPrecision="6" classificationMode="1">
          <item color="#000000" value="1e-06" alpha="0" label="Of this sky's light, by each pixel:"/>
          <item color="#481e6f" value="1e-05" alpha="255" label="0.0001–0.001 %"/>
          <item color="#3f4789" value="3e-05" alpha="255" label="0.001–0.003 %"/>
          <item color="#306a8e" value="0.0001" alpha="255" label="0.003–0.01 %"/>
          <item color="#238a8e" value="0.0003" alpha="255" label="0.01–0.03 %"/>
          <item color="#24a983" value="0.001" alpha="255" label="0.03–0.1 %"/>
          <item color="#56c666" value="0.003" alpha="255" label="0.1–0.3 %"/>
          <item color="#a6db35" value="0.01" alpha="255" label="0.3–1 %"/>
          <item color="#fde725" value="inf" alpha="255" label="above 1 %"/>
          <rampLegendSettings minimumLabel="" orientation="2" useContinuousLegend="1" maximumLabel="" direction="0" suffix="" prefix="">
            <numericFormat id="basic">
              <Option type="Map">
                <Option type="QChar" value="" name="decimal_separator"/>
                <Option type="int" value="6" name="decimals"/>
                <Option type="int" value="0" name="rounding_type"/>
                <Option type="bool" value="false" name="show_plus"/>
                <Option type="bool" value="true" name="show_thousand_separator"/>
                <Option type="bool" value="false" name="show_trailing_zeros"/>
                <Option type="QChar" value="" name="thousand_separator"/>
              </Option>
            </numericFormat>
          </rampLegendSettings>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast contrast="0" brightness="0" gamma="1"/>
    <huesaturation grayscaleMode="0" invertColors="0" saturation="0" colorizeRed="255" colorizeOn="0" colorizeStrength="100" colorizeGreen="128" colorizeBlue="128"/>
    <rasterresampler maxOversampling="2"/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
