<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22.16-Białowieża" styleCategories="Symbology|Labeling">
  <pipe-data-defined-properties>
    <Option type="Map">
      <Option type="QString" name="name" value=""/>
      <Option name="properties"/>
      <Option type="QString" name="type" value="collection"/>
    </Option>
  </pipe-data-defined-properties>
  <pipe>
    <provider>
      <resampling zoomedInResamplingMethod="nearestNeighbour" zoomedOutResamplingMethod="nearestNeighbour" enabled="false" maxOversampling="2"/>
    </provider>
    <rasterrenderer type="singlebandpseudocolor" band="1" classificationMin="0" classificationMax="0.00936162427773753" alphaBand="-1" opacity="0.85" nodataColor="">
      <minMaxOrigin>
        <limits>None</limits>
        <extent>WholeRaster</extent>
        <statAccuracy>Estimated</statAccuracy>
        <cumulativeCutLower>0.02</cumulativeCutLower>
        <cumulativeCutUpper>0.98</cumulativeCutUpper>
        <stdDevFactor>2</stdDevFactor>
      </minMaxOrigin>
      <rastershader>
        <colorrampshader clip="0" minimumValue="0" maximumValue="0.0093616242777375264" colorRampType="DISCRETE" classificationMode="1" labelPrecision="6">
          <item alpha="0" value="2.28555280218201e-06" color="#000000" label="Relative to the natural sky:"/>
          <item alpha="255" value="4.57110560436403e-06" color="#0d0887" label="1 % – 2 %"/>
          <item alpha="255" value="9.14221120872805e-06" color="#3a049b" label="2 % – 4 %"/>
          <item alpha="255" value="1.82844224174561e-05" color="#5d01a6" label="4 % – 8 %"/>
          <item alpha="255" value="3.65688448349122e-05" color="#7e03a8" label="8 % – 16 %"/>
          <item alpha="255" value="7.31376896698244e-05" color="#9c179e" label="16 % – 32 %"/>
          <item alpha="255" value="0.000146275379339649" color="#b52f8c" label="32 % – 64 %"/>
          <item alpha="255" value="0.000292550758679298" color="#cb4778" label="64 % – 1.3 ×"/>
          <item alpha="255" value="0.000585101517358595" color="#dd6065" label="1.3 × – 2.6 ×"/>
          <item alpha="255" value="0.00117020303471719" color="#ed7953" label="2.6 × – 5.1 ×"/>
          <item alpha="255" value="0.00234040606943438" color="#f89541" label="5.1 × – 10.2 ×"/>
          <item alpha="255" value="0.00468081213886876" color="#feb32f" label="10.2 × – 20.5 ×"/>
          <item alpha="255" value="0.00936162427773753" color="#fbd524" label="20.5 × – 41 ×"/>
          <item alpha="255" value="inf" color="#f0f921" label="above 41 ×"/>
          <rampLegendSettings suffix="" prefix="" useContinuousLegend="1" minimumLabel="" orientation="2" maximumLabel="" direction="0">
            <numericFormat id="basic">
              <Option type="Map">
                <Option type="QChar" name="decimal_separator" value=""/>
                <Option type="int" name="decimals" value="6"/>
                <Option type="int" name="rounding_type" value="0"/>
                <Option type="bool" name="show_plus" value="false"/>
                <Option type="bool" name="show_thousand_separator" value="true"/>
                <Option type="bool" name="show_trailing_zeros" value="false"/>
                <Option type="QChar" name="thousand_separator" value=""/>
              </Option>
            </numericFormat>
          </rampLegendSettings>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <huesaturation saturation="0" colorizeGreen="128" colorizeBlue="128" colorizeStrength="100" colorizeRed="255" invertColors="0" grayscaleMode="0" colorizeOn="0"/>
    <rasterresampler maxOversampling="2"/>
    <resamplingStage>resamplingFilter</resamplingStage>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
